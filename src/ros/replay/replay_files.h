/// @file
/// Room `ros/replay`, private: the files of a replay, and that no result replaces what it reads. Options in; a scene or a refusal out.
#pragma once

#include <vector>

#include "ros/publish/publish_options.h"
#include "ros/replay/replay.h"
#include "tissue_contact/core/whole_file.h"
#include "tissue_contact/simulation/scene.h"
#include "tissue_contact/simulation/simulator.h"

namespace tissue_contact {

/// Reads the scene; refuses a bag that is no regular file, and results that would replace the scene, the bag, a URDF or a
/// mesh the scene names, or each other.
/// @throws std::exception saying what is wrong.
Scene loadReplayedScene(const ReplayOptions& options, PublishOptions& publish);

/// The same for the meshes that the robot models name.
void requireModelsKept(const ReplayOptions& options, const Simulator& simulator);

/// Whether gmsh fills a surface for the scene.
bool fillsMesh(const Scene& scene);

/// All files that a replay reads, by role; paths that are not given are empty.
std::vector<NamedFile> inputFiles(const ReplayOptions& options, const Simulator& simulator);

}  // namespace tissue_contact
