/// @file
/// Room `ros`: the node: joint states in, wrenches, meshes, contacts and markers out.
#pragma once

#include <diagnostic_updater/diagnostic_updater.h>
#include <ros/node_handle.h>
#include <ros/subscriber.h>
#include <ros/timer.h>
#include <sensor_msgs/JointState.h>

#include <memory>
#include <vector>

#include "tissue_contact/ros/health.h"
#include "tissue_contact/ros/outputs.h"
#include "tissue_contact/simulation/joint_state_player.h"
#include "tissue_contact/simulation/simulator.h"

namespace tissue_contact {

/// Private parameters: ~scene (path of the scene file, required), ~tf_timeout_s (see environment.h),
/// ~markers/displacement_full_scale_m and ~markers/force_arrow_m_per_n (see scene_markers.h), and the URDF parameters
/// that the scene names. Topics: see outputs.h; diagnostics on /diagnostics once per second of wall time.
class Node {
 public:
  /// Builds the scene, then advertises and subscribes. Nothing is advertised if it throws.
  /// @throws std::exception naming the parameter or file at fault and what to do.
  Node();

 private:
  void subscribe();
  void handle(int topic, const sensor_msgs::JointState& message);
  bool playNext();

  ros::NodeHandle node_;
  ros::NodeHandle private_node_;
  Simulator simulator_;
  JointStatePlayer player_;
  Outputs outputs_;
  Health health_;
  diagnostic_updater::Updater updater_;
  ros::WallTimer diagnostics_timer_;
  std::vector<ros::Subscriber> subscribers_;
};

/// Runs the node until it is asked to stop. @return exit code: 0, or 1 after one fatal message when it cannot start.
int runNode(int argc, char** argv);

}  // namespace tissue_contact
