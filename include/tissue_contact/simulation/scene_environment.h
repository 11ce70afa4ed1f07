/// @file
/// Room `simulation`: what a scene refers to outside its own file.
#pragma once

#include <functional>
#include <string>

#include "tissue_contact/core/resolve_path.h"
#include "tissue_contact/core/types.h"
#include "tissue_contact/mesh/mesh_preparation.h"

namespace tissue_contact {

/// Members may be empty when the scene needs none of them; a scene that does need one is refused with a message that
/// names it.
struct SceneEnvironment {
  PackagePath package_path;                                            ///< directory of a ROS package
  std::function<std::string(const std::string& parameter)> urdf_text;  ///< URDF held by a parameter; throws if missing
  std::function<Pose(const std::string& tf_frame)> frame_pose;         ///< X_WF of a tf frame; throws if unknown
  /// Seconds, never back; for solver.time_budget_s, Simulator::setSolverDeadline and what `meshes` says.
  std::function<double()> clock;
  MeshPreparation meshes;
};

}  // namespace tissue_contact
