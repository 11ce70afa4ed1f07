#include "ros/node/control_services.h"

#include <ros/console.h>

namespace tissue_contact {
namespace {

/// Longer than a step that a user would wait for.
constexpr double kPatience_s = 5.0;

template <typename Response>
bool take(const std::string& name, const Answer& answer, Response& response) {
  response.success = static_cast<decltype(response.success)>(answer.success);
  response.message = answer.message;
  if (answer.success) {
    ROS_INFO_STREAM(name << ": " << answer.message);
  } else {
    ROS_WARN_STREAM(name << " refused: " << answer.message);
  }
  return true;
}

}  // namespace

void ControlServices::start(ros::NodeHandle private_node) {
  private_node.setCallbackQueue(&queue_);
  offer(private_node, "reset", &Stepper::reset);
  offer(private_node, "pause", &Stepper::pause);
  offer(private_node, "resume", &Stepper::resume);
  offer(private_node, "step", &Stepper::stepOnce);
  offer(private_node, "save_state", &Stepper::saveState);
  offer(private_node, "load_state", &Stepper::loadState);
  spinner_.start();
}

std::vector<std::string> ControlServices::names() const {
  std::vector<std::string> names;
  for (const ros::ServiceServer& server : servers_) names.push_back(server.getService());
  return names;
}

void ControlServices::stop() {
  spinner_.stop();
  servers_.clear();
}

void ControlServices::offer(ros::NodeHandle& node, const std::string& name, Answer (Stepper::*action)()) {
  const boost::function<bool(std_srvs::Trigger::Request&, std_srvs::Trigger::Response&)> serve =
      [this, name, action](std_srvs::Trigger::Request& /*request*/, std_srvs::Trigger::Response& response) {
        return take(name, stepper_.requests().ask([&] { return (stepper_.*action)(); }, kPatience_s), response);
      };
  servers_.push_back(node.advertiseService(name, serve));
}

void ControlServices::offer(ros::NodeHandle& node, const std::string& name,
                            Answer (Stepper::*action)(const std::string& file)) {
  const boost::function<bool(StateFile::Request&, StateFile::Response&)> serve = [this, name, action](
                                                                                     StateFile::Request& request,
                                                                                     StateFile::Response& response) {
    return take(name, stepper_.requests().ask([&] { return (stepper_.*action)(request.file); }, kPatience_s), response);
  };
  servers_.push_back(node.advertiseService(name, serve));
}

}  // namespace tissue_contact
