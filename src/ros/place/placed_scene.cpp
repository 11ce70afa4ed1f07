#include "ros/place/placed_scene.h"

#include <iostream>
#include <stdexcept>
#include <string>

#include "ros/publish/publish_options.h"
#include "scene/read_more.h"
#include "tissue_contact/core/read_file.h"
#include "tissue_contact/ros/environment.h"

namespace tissue_contact {

PlacedScene::PlacedScene(const PlaceOptions& options)
    : scene(loadScene(options.scene_file, packagePath, {}, parsePublish)),
      environment(bagEnvironment(scene, options.bag_file, options.urdf_file)) {
  environment.meshes.say = [](const std::string& line) { std::cerr << "tissue_contact_place: " << line << "\n"; };
  if (!options.bag_file.empty()) {
    requireRegularFile(options.bag_file, "bag");
    return;
  }
  environment.frame_pose = [](const std::string& frame) -> Pose {
    throw std::invalid_argument("the scene takes tf frame '" + frame + "' from a bag; give one with --bag");
  };
}

}  // namespace tissue_contact
