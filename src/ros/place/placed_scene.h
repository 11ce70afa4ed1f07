/// @file
/// Room `ros/place`, private: the scene that is looked at. Options in; the scene and what it refers to out.
#pragma once

#include "ros/place/place.h"
#include "tissue_contact/simulation/scene.h"
#include "tissue_contact/simulation/scene_environment.h"

namespace tissue_contact {

/// A scene as the node and the replay read it.
struct PlacedScene {
  /// @throws std::exception saying what is wrong.
  explicit PlacedScene(const PlaceOptions& options);

  Scene scene;
  SceneEnvironment environment;
};

}  // namespace tissue_contact
