/// @file
/// Room `ros`: see node.h.
#include "tissue_contact/ros/node.h"

#include <ros/init.h>

#include <chrono>
#include <exception>
#include <stdexcept>
#include <string>

#include "tissue_contact/ros/environment.h"
#include "tissue_contact/scene/load_scene.h"

namespace tissue_contact {
namespace {

/// Every joint state must give a wrench, so none may be dropped while a step takes long: a bag played too fast for this
/// machine waits here. Bounded, because nothing may grow for ever: 200 s of a 500 Hz topic, about 60 MB.
constexpr int kJointStateQueue = 100000;

Simulator makeSimulator(const ros::NodeHandle& private_node) {
  const std::string parameter = private_node.resolveName("scene");
  std::string file;
  if (!private_node.getParam("scene", file) || file.empty()) {
    throw std::invalid_argument(
        "parameter '" + parameter +
        "' is not set to the path of a scene file; start the node with _scene:=/path/scene.yaml "
        "or <param name=\"scene\" value=\"...\"/>");
  }
  try {
    const Scene scene = loadScene(file, packagePath);
    return {scene, nodeEnvironment(private_node, scene.world_frame)};
  } catch (const std::exception& error) {
    throw std::invalid_argument("parameter '" + parameter + "' (" + file + "): " + error.what());
  }
}

}  // namespace

Node::Node()
    : private_node_("~"),
      simulator_(makeSimulator(private_node_)),
      player_(simulator_),
      outputs_(private_node_, simulator_, player_),
      health_(simulator_, player_) {
  for (const std::string& line : simulator_.advice()) ROS_INFO_STREAM("advisor: " << line);
  updater_.setHardwareID("none");
  updater_.add("tissue contact", [this](diagnostic_updater::DiagnosticStatusWrapper& status) { health_.fill(status); });
  // By the wall clock: with simulated time a bag that is paused or over would silence the diagnostics.
  diagnostics_timer_ =
      node_.createWallTimer(ros::WallDuration(1.0), [this](const ros::WallTimerEvent&) { updater_.force_update(); });
  subscribe();
}

void Node::subscribe() {
  for (std::size_t i = 0; i < player_.topics().size(); ++i) {
    const auto callback = [this, i](const sensor_msgs::JointStateConstPtr& message) {
      handle(static_cast<int>(i), *message);
    };
    subscribers_.push_back(node_.subscribe<sensor_msgs::JointState>(
        player_.topics()[i], kJointStateQueue, callback, ros::VoidConstPtr(), ros::TransportHints().tcpNoDelay()));
  }
}

void Node::handle(int topic, const sensor_msgs::JointState& message) {
  player_.push(topic, toSample(message));
  while (playNext()) {
  }
}

/// Plays and publishes one sample; false when none is ready.
bool Node::playNext() {
  using Clock = std::chrono::steady_clock;
  const long steps_before = simulator_.stepCount();
  const Clock::time_point start = Clock::now();
  const auto played = player_.playNext();
  if (!played) return false;
  const std::chrono::duration<double> elapsed = Clock::now() - start;
  const auto steps = static_cast<int>(simulator_.stepCount() - (played->was_reset ? 0 : steps_before));
  if (health_.note(*played, steps > 0)) {
    outputs_.publish(*played, steps, steps > 0 ? elapsed.count() / steps : 0.0);
  }
  return true;
}

int runNode(int argc, char** argv) {
  ros::init(argc, argv, "tissue_contact");
  const ros::NodeHandle keep_alive;  // so that the fatal message still reaches /rosout
  try {
    const Node node;
    ros::spin();
    return 0;
  } catch (const std::exception& error) {
    ROS_FATAL_STREAM(error.what());
    return 1;
  }
}

}  // namespace tissue_contact
