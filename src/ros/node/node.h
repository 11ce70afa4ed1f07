/// @file
/// Room `ros`, private: the node: joint states in, wrenches, meshes, contacts and markers out.
#pragma once

#include <diagnostic_updater/diagnostic_updater.h>
#include <ros/node_handle.h>
#include <ros/service_server.h>

#include <atomic>
#include <condition_variable>
#include <memory>
#include <mutex>
#include <string>
#include <thread>
#include <vector>

#include "ros/node/control_services.h"
#include "ros/node/frame_watch.h"
#include "ros/node/health.h"
#include "ros/node/joint_state_inbox.h"
#include "ros/node/live_tuning.h"
#include "ros/node/master_watch.h"
#include "ros/node/receiver.h"
#include "ros/node/stepper.h"
#include "ros/publish/outputs.h"
#include "ros/publish/publish_options.h"
#include "tissue_contact/simulation/joint_state_player.h"
#include "tissue_contact/simulation/simulator.h"

namespace tissue_contact {

/// Private parameters: kNodeUsage in node.cpp. Topics: see outputs.h; diagnostics on /diagnostics once per second of wall time.
///
/// Services: control_services.h. A node of its own (runNode()) or one of several in a process (nodelet.cpp).
///
/// Threads, and what is between them:
///   receiving    Receiver: joint states into inbox_, which is locked for a move at a time
///   stepping     Stepper: inbox_ -> player_ -> simulator_ -> wrenches; alone in touching player_, simulator_ and outputs_
///   publishing   SnapshotPublisher inside outputs_: snapshots through a locked queue; of simulator_ only what is const
///   diagnostics  here: LiveFigures of health_, which is locked for a copy at a time
///   master       MasterWatch: asks the ROS master once per second whether it knows this node
///   services     ControlServices: each waits until the stepping thread has answered it (RequestQueue)
///   roscpp's     its callbacks: a subscriber came (an atomic flag, and inbox_ wakes the stepping thread); numbers to change
///                (tuning_, which is locked for a copy, and an atomic flag)
/// None but the services' waits for another's work.
class Node {
 public:
  /// Builds the scene; advertises and subscribes nothing yet.
  /// @param node, private_node by which names are resolved.
  /// @param name of the node, for diagnostics.
  /// @param arguments names of the private parameters that came by the command line.
  /// @throws std::exception naming the parameter or file at fault and what to do.
  Node(const ros::NodeHandle& node, const ros::NodeHandle& private_node, const std::string& name,
       const std::vector<std::string>& arguments);
  ~Node() { stop(); }
  Node(const Node&) = delete;
  Node& operator=(const Node&) = delete;

  /// Advertises, subscribes and works from now on.
  void start();
  void stop();
  /// Whether it had to stop by itself, after one fatal message. Any thread.
  bool failed() const { return stepper_.failed(); }

  /// Prints what became of every joint state, once. Any thread.
  void tellCounts();

 private:
  void tellDiagnostics();

  ros::NodeHandle private_node_;
  PublishOptions publish_;
  std::vector<PlacedFrame> placed_frames_;
  Simulator simulator_;
  JointStatePlayer player_;
  JointStateInbox inbox_;
  Health health_;
  Outputs outputs_;
  LiveTuning tuning_;
  Stepper stepper_;
  ControlServices services_;
  Receiver receiver_;
  ros::ServiceServer loggers_;
  MasterWatch master_;
  std::unique_ptr<FrameWatch> frames_;  ///< null: the scene names none
  std::atomic<bool> counts_told_{false};

  diagnostic_updater::Updater updater_;
  std::mutex diagnostics_mutex_;
  std::condition_variable diagnostics_changed_;
  bool diagnostics_stop_ = false;  ///< guarded by diagnostics_mutex_
  std::thread diagnostics_thread_;
};

/// Runs the node until it is asked to stop.
/// @return exit code: 0, or 1 after one fatal message when it cannot start or go on.
int runNode(int argc, char** argv);

}  // namespace tissue_contact
