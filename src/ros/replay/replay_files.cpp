#include "ros/replay/replay_files.h"

#include <algorithm>
#include <string>
#include <variant>
#include <vector>

#include "scene/read_more.h"
#include "tissue_contact/core/read_file.h"
#include "tissue_contact/core/whole_file.h"
#include "tissue_contact/ros/environment.h"

namespace tissue_contact {
namespace {

std::vector<NamedFile> outputsOf(const ReplayOptions& options) {
  const std::string partial = options.out_file.empty() ? "" : options.out_file + WholeFile::kPartialEnding;
  return {{"--csv", options.csv_file},
          {"--out", options.out_file},
          {"--out, if it is interrupted,", partial},
          {"--timing", options.timing_file},
          {"--manifest", options.manifest_file},
          {"--dump-file", options.dump_file}};
}

void addMeshes(const std::vector<ShapeDescription>& shapes, const std::string& whose, std::vector<NamedFile>& files) {
  for (const ShapeDescription& shape : shapes) {
    if (const auto* mesh = std::get_if<MeshGeometry>(&shape.geometry)) files.push_back({whose, mesh->file});
  }
}

std::vector<NamedFile> filesOf(const Scene& scene) {
  std::vector<NamedFile> files = {{"--scene", scene.file}};
  for (const TissueDescription& tissue : scene.tissues) {
    const std::string whose = "the scene's tissue mesh";
    if (const auto* mesh = std::get_if<MeshDescription>(&tissue.geometry)) files.push_back({whose, mesh->file});
    if (const auto* shell = std::get_if<ShellDescription>(&tissue.geometry)) files.push_back({whose, shell->file});
  }
  for (const InstrumentDescription& instrument : scene.instruments) {
    files.push_back({"the scene's URDF", instrument.urdf_file});
    for (const ContactLinkDescription& link : instrument.contact_links) {
      addMeshes(link.shapes, "the scene's shape", files);
    }
  }
  return files;
}

std::vector<NamedFile> modelFiles(const Simulator& simulator) {
  std::vector<NamedFile> meshes;
  for (const Instrument& instrument : simulator.instruments()) {
    for (const RobotModel::Link& link : instrument.model().links()) {
      addMeshes(link.geometry.collision, "the URDF's mesh", meshes);
      addMeshes(link.geometry.visual, "the URDF's mesh", meshes);
    }
  }
  return meshes;
}

}  // namespace

Scene loadReplayedScene(const ReplayOptions& options, PublishOptions& publish) {
  requireRegularFile(options.bag_file, "bag");
  requireFreeOutputs(outputsOf(options),
                     {{"--scene", options.scene_file}, {"--bag", options.bag_file}, {"--urdf", options.urdf_file}});
  // Also where nothing is published: a mistake is one wherever the scene is used.
  Scene scene = loadScene(options.scene_file, packagePath, options.settings,
                          [&](const YamlMap& file) { publish = parsePublish(file); });
  requireFreeOutputs(outputsOf(options), filesOf(scene));
  return scene;
}

void requireModelsKept(const ReplayOptions& options, const Simulator& simulator) {
  requireFreeOutputs(outputsOf(options), modelFiles(simulator));
}

bool fillsMesh(const Scene& scene) {
  return std::any_of(scene.tissues.begin(), scene.tissues.end(), [](const TissueDescription& tissue) {
    const auto* mesh = std::get_if<MeshDescription>(&tissue.geometry);
    return mesh != nullptr && mesh->cell_size_m != 0.0;
  });
}

std::vector<NamedFile> inputFiles(const ReplayOptions& options, const Simulator& simulator) {
  std::vector<NamedFile> files = {{"--bag", options.bag_file}, {"--urdf", options.urdf_file}};
  for (const auto& more : {filesOf(simulator.scene()), modelFiles(simulator)}) {
    files.insert(files.end(), more.begin(), more.end());
  }
  return files;
}

}  // namespace tissue_contact
