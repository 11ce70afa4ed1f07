/// @file
/// Room `ros`: see node.h.
#include "tissue_contact/ros/node.h"

#include <ros/callback_queue.h>
#include <ros/console.h>
#include <ros/init.h>
#include <ros/time.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <exception>
#include <stdexcept>
#include <string>
#include <vector>

#include "tissue_contact/ros/environment.h"
#include "tissue_contact/ros/logger_service.h"
#include "tissue_contact/ros/private_parameters.h"
#include "tissue_contact/scene/load_scene.h"

namespace tissue_contact {
namespace {

/// Where every joint state gives a wrench none may be dropped while a step takes long: a bag played too fast for this
/// machine waits here. Bounded, because nothing may grow for ever: 200 s of a 500 Hz topic, about 60 MB.
constexpr std::size_t kJointStateQueue = 100000;

Simulator makeSimulator(const ros::NodeHandle& private_node, const std::vector<std::string>& arguments) {
  const std::string parameter = private_node.resolveName("scene");
  std::string file;
  if (!private_node.getParam("scene", file) || file.empty()) {
    refuseUnknownParameters(private_node, nullptr, arguments);  // it may be there, misspelt
    throw std::invalid_argument(
        "parameter '" + parameter +
        "' is not set to the path of a scene file; start the node with _scene:=/path/scene.yaml "
        "or <param name=\"scene\" value=\"...\"/>");
  }
  const auto naming_file = [&](const std::exception& error) {
    return std::invalid_argument("parameter '" + parameter + "' (" + file + "): " + error.what());
  };
  Scene scene;
  try {
    scene = loadScene(file, packagePath);
  } catch (const std::exception& error) {
    throw naming_file(error);
  }
  refuseUnknownParameters(private_node, &scene, arguments);
  try {
    return {scene, nodeEnvironment(private_node, scene.world_frame)};
  } catch (const std::exception& error) {
    throw naming_file(error);
  }
}

}  // namespace

Node::Node(ShutdownGuard& guard, const std::vector<std::string>& arguments)
    : guard_(guard),
      private_node_("~"),
      simulator_(makeSimulator(private_node_, arguments)),
      player_(simulator_),
      inbox_(kJointStateQueue),
      health_(simulator_, player_, inbox_),
      outputs_(private_node_, simulator_, player_, health_),
      stepper_(simulator_, player_, inbox_, outputs_, health_, ros::Time::isSimTime()),
      receiver_(inbox_) {
  for (const std::string& line : simulator_.advice()) ROS_INFO_STREAM("advisor: " << line);
  health_.setPublishers([this](int topic) { return receiver_.publishers(topic); });
  updater_.setHardwareID("none");
  updater_.add("tissue contact", [this](diagnostic_updater::DiagnosticStatusWrapper& status) {
    health_.fill(receiver_.missing(), status);
  });
  updater_.add("ROS master", [this](diagnostic_updater::DiagnosticStatusWrapper& status) { master_.fill(status); });
}

Node::~Node() {
  guard_.setLastWords(nullptr);
  stop();
}

int Node::run() {
  guard_.setLastWords([this] {
    tellCounts();
    ros::shutdown();  // so that the master forgets us
  });
  outputs_.start([this] { inbox_.wake(); });
  stepper_.start();
  receiver_.start(player_.topics());
  loggers_ = advertiseLoggers(private_node_);
  master_.start();
  diagnostics_thread_ = std::thread([this] { tellDiagnostics(); });
  constexpr double kWakeUp = 0.05;  // s: how long a signal may go unseen
  while (ros::ok() && !guard_.asked() && !stepper_.failed()) {
    ros::getGlobalCallbackQueue()->callAvailable(ros::WallDuration(kWakeUp));
  }
  if (!stepper_.failed()) guard_.ask();  // rosnode kill: nothing may hang then either
  stop();
  tellCounts();
  return stepper_.failed() ? 1 : 0;
}

void Node::stop() {
  stepper_.stop();
  receiver_.stop();
  master_.stop();
  {
    const std::lock_guard<std::mutex> lock(diagnostics_mutex_);
    diagnostics_stop_ = true;
  }
  diagnostics_changed_.notify_all();
  if (diagnostics_thread_.joinable()) diagnostics_thread_.join();
}

/// By the wall clock: with simulated time a bag that is paused or over would silence the diagnostics.
void Node::tellDiagnostics() {
  using Clock = std::chrono::steady_clock;
  constexpr std::chrono::seconds kPeriod(1);
  std::unique_lock<std::mutex> lock(diagnostics_mutex_);
  for (Clock::time_point next = Clock::now() + kPeriod;
       !diagnostics_changed_.wait_until(lock, next, [this] { return diagnostics_stop_; });
       next = std::max(next + kPeriod, Clock::now())) {
    lock.unlock();
    updater_.force_update();
    lock.lock();
  }
}

void Node::tellCounts() {
  if (counts_told_.exchange(true)) return;
  // Not through the log, which may block, and is closed after rosnode kill.
  std::printf("%s\n", countsLine(health_.figures()).c_str());
  std::fflush(stdout);
}

int runNode(int argc, char** argv) {
  ShutdownGuard guard;
  // Before anything of ROS, which would wait for a master.
  const std::string problem = argumentProblem(argc, argv);
  if (!problem.empty()) {
    ROS_FATAL_STREAM(problem);
    return 1;
  }
  const std::vector<std::string> arguments = privateArguments(argc, argv);
  ros::init(argc, argv, "tissue_contact", ros::init_options::NoSigintHandler);
  int code = 1;
  try {
    const ros::NodeHandle keep_alive;  // so that the fatal message still reaches /rosout
    try {
      code = Node(guard, arguments).run();
    } catch (const std::exception& error) {
      if (guard.asked()) return 0;  // what was waited for need not be there any more
      ROS_FATAL_STREAM(error.what());
    }
  } catch (const std::exception& error) {
    ROS_FATAL_STREAM(error.what());
  }
  ros::shutdown();
  return code;
}

}  // namespace tissue_contact
