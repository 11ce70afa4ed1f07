/// @file
/// Room `simulation`: turns a scene description and its environment into instruments and tissues.
#pragma once

#include <functional>
#include <string>
#include <vector>

#include "tissue_contact/contact/mesh_preparation.h"
#include "tissue_contact/contact/tissue_pair_detector.h"
#include "tissue_contact/instrument/instrument.h"
#include "tissue_contact/scene/load_scene.h"
#include "tissue_contact/scene/scene.h"
#include "tissue_contact/tissue/tissue.h"

namespace tissue_contact {

/// What a scene refers to outside its own file. Members may be empty when the scene needs none of them; a scene that
/// does need one is refused with a message that names it.
struct SceneEnvironment {
  PackagePath package_path;                                            ///< directory of a ROS package
  std::function<std::string(const std::string& parameter)> urdf_text;  ///< URDF held by a parameter; throws if missing
  std::function<Pose(const std::string& tf_frame)> frame_pose;         ///< X_WF of a tf frame; throws if unknown
  /// Seconds, never back; for solver.time_budget_s, Simulator::setSolverDeadline and what `meshes` says.
  std::function<double()> clock;
  MeshPreparation meshes;
};

/// @throws std::invalid_argument naming what is wrong in the scene or its files.
std::vector<Instrument> buildInstruments(const Scene& scene, const SceneEnvironment& environment);
std::vector<Tissue> buildTissues(const Scene& scene, const SceneEnvironment& environment);

/// The scene's tissue pairs by index. @throws std::invalid_argument naming a tissue that is not there.
std::vector<TouchingTissues> buildTissuePairs(const Scene& scene);

/// The linearised cones and impulses know one coefficient for all directions.
/// @throws std::invalid_argument when solver.method is one of them and some friction depends on direction.
void requireMethodForLaws(const Scene& scene);

}  // namespace tissue_contact
