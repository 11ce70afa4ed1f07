/// @file
/// Room `ros`: where a scene gets what its file only names: package directories, URDF parameters, tf frames.
#pragma once

#include <ros/node_handle.h>

#include <stdexcept>
#include <string>

#include "tissue_contact/simulation/simulator.h"

namespace tissue_contact {

/// Seconds of wall time on a clock that never goes back: the one nodeEnvironment() and bagEnvironment() give to solvers.
double steadySeconds();

/// Directory of a package through rospack; empty where it is not found.
std::string packagePath(const std::string& package);

/// For a running node: packages through rospack, URDF text from the parameter server, frames through tf2.
///
/// URDF parameters are looked up in the private namespace first, then in the node's namespace and upwards to the global
/// one. Frames are looked up once, when the scene is built, waiting up to the private parameter `~tf_timeout_s` (wall
/// time; default 10 s: a robot's own start-up takes about that long).
/// @param private_node handle of the private namespace.
/// @param world_frame frame the poses are wanted in.
/// @throws std::invalid_argument when ~tf_timeout_s is no number from 0 to 1e6; the members throw it, naming what they tried.
SceneEnvironment nodeEnvironment(const ros::NodeHandle& private_node, const std::string& world_frame);

/// A URDF file is given that would change nothing: an argument is wrong, not a file.
class UnusedUrdf : public std::invalid_argument {
 public:
  using std::invalid_argument::invalid_argument;
};

/// For offline replay: packages through rospack, URDF text from a file, frames from the bag's /tf_static and /tf, each
/// at the earliest moment it is known. Needs no roscore.
/// @param scene that is to be built.
/// @param bag_file bag to take frames from, opened when the first frame is wanted.
/// @param urdf_file text to use for every URDF parameter; empty: a scene that wants one is refused.
/// @throws UnusedUrdf when there is a `urdf_file` and no instrument of the scene takes its URDF from a parameter.
SceneEnvironment bagEnvironment(const Scene& scene, const std::string& bag_file, const std::string& urdf_file);

}  // namespace tissue_contact
