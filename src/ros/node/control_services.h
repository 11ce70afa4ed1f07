/// @file
/// Room `ros`, private: the services by which a running node is reset, paused, stepped, saved and restored.
#pragma once

#include <ros/callback_queue.h>
#include <ros/node_handle.h>
#include <ros/service_server.h>
#include <ros/spinner.h>
#include <std_srvs/Trigger.h>

#include <string>
#include <vector>

#include "ros/node/stepper.h"
#include "tissue_contact/StateFile.h"

namespace tissue_contact {

/// ~reset, ~pause, ~resume, ~step (std_srvs/Trigger), ~save_state, ~load_state (StateFile). Called in a thread of their own, since each
/// waits for the stepping thread to come between two moments.
class ControlServices {
 public:
  /// @param stepper must outlive this.
  explicit ControlServices(Stepper& stepper) : stepper_(stepper), spinner_(1, &queue_) {}
  ~ControlServices() { stop(); }
  ControlServices(const ControlServices&) = delete;
  ControlServices& operator=(const ControlServices&) = delete;

  void start(ros::NodeHandle private_node);
  std::vector<std::string> names() const;  ///< from / on
  /// After the stepper has stopped, or a service that waits for it would hold this up.
  void stop();

 private:
  void offer(ros::NodeHandle& node, const std::string& name, Answer (Stepper::*action)());
  void offer(ros::NodeHandle& node, const std::string& name, Answer (Stepper::*action)(const std::string& file));

  Stepper& stepper_;
  ros::CallbackQueue queue_;
  ros::AsyncSpinner spinner_;
  std::vector<ros::ServiceServer> servers_;
};

}  // namespace tissue_contact
