/// @file
/// Room `ros`: what an offline replay reads and writes, checked before anything is computed.
#pragma once

#include "tissue_contact/ros/replay_options.h"
#include "tissue_contact/scene/scene.h"
#include "tissue_contact/simulation/simulator.h"

namespace tissue_contact {

/// Reads the scene; refuses a bag that is no regular file, and results that would replace the scene, the bag, a URDF or
/// a mesh the scene names, or each other. @throws std::invalid_argument; as loadScene.
Scene loadReplayedScene(const ReplayOptions& options);

/// The same for the meshes that the robot models name. @throws std::invalid_argument.
void requireModelsKept(const ReplayOptions& options, const Simulator& simulator);

}  // namespace tissue_contact
