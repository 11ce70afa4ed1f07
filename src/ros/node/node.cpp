#include "ros/node/node.h"

#include <ros/callback_queue.h>
#include <ros/console.h>
#include <ros/init.h>
#include <ros/this_node.h>
#include <ros/time.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <exception>
#include <iostream>
#include <memory>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "ros/node/logger_service.h"
#include "ros/node/private_parameters.h"
#include "ros/node/shutdown_guard.h"
#include "ros/parameter.h"
#include "ros/publish/publish_options.h"
#include "scene/read_more.h"
#include "tissue_contact/core/text.h"
#include "tissue_contact/core/whole_file.h"
#include "tissue_contact/ros/environment.h"
#include "tissue_contact/simulation/scene.h"

namespace tissue_contact {
namespace {

constexpr const char* kNodeUsage =
    R"(usage: rosrun tissue_contact tissue_contact_node _scene:=SCENE.yaml [_parameter:=value] [from:=to] [__name:=name]

Contact forces between instruments and soft tissue: joint states in, wrenches and deformed tissue out. Needs a ROS master
(roscore, or roslaunch). Without one: tissue_contact_replay.

private parameters
  ~scene               the scene (doc/scene.md): a path, or package://PACKAGE/PATH
  ~set                 keys of the scene, as if its file said so: a list of KEY=VALUE, or one,
                       tissues.block.material.youngs_modulus_pa=4000; elements of lists by name or index
  ~robot_description   text of a URDF, for scenes that take it from this parameter (or from another that they name);
                       looked for here, then in every namespace up to /
  ~tf_timeout_s        how long to wait for tf frames that the scene names, s; default 10
  ~publish_mesh        refined (default) or unrefined: the mesh of a tissue that is refined while it is touched, as it is
                       or as it was at the start
  ~markers/color       what colours show in RViz: displacement (default), pressure or strain
  ~markers/...         displacement_full_scale_m, pressure_full_scale_pa, strain_full_scale, force_arrow_m_per_n: fixed
                       scales in RViz; without them they fit what has been shown so far
  any other argument, also _parameter:=value, is refused; of what is set on the parameter server, misspelt names only

subscribed topics
  as the scene names them  sensor_msgs/JointState

published topics
  ~INSTRUMENT/wrench   geometry_msgs/WrenchStamped of the tissue on the instrument, one per state of the arm stepped to
  ~INSTRUMENT/body/measured_cf, ~INSTRUMENT/spatial/measured_cf
                       the same of the instrument on the tissue, where the scene says publish: {crtk: true}
  ~TISSUE/topology     tissue_contact/TissueTopology, latched; again when the mesh has changed
  ~TISSUE/mesh         tissue_contact/TissueMesh
  ~contacts            tissue_contact/ContactArray
  ~status              tissue_contact/Status
  ~markers             visualization_msgs/MarkerArray
  ~changes             tissue_contact/Changes, latched: numbers of the scene changed while it runs; replay repeats them
  /diagnostics         diagnostic_msgs/DiagnosticArray

services
  ~pause ~resume       std_srvs/Trigger: joint states wait meanwhile
  ~step                std_srvs/Trigger: while paused, to the next joint state (newest_state: the newest)
  ~reset               std_srvs/Trigger: tissues undeformed and at rest
  ~save_state          tissue_contact/StateFile: all that the next step depends on, into a file
  ~load_state          tissue_contact/StateFile: goes on from such a file, of the same scene

changing numbers while it runs
  ~set_parameters, ~parameter_descriptions, ~parameter_updates: dynamic_reconfigure (rqt_reconfigure, dynparam); doc/node.md

example
  rosrun tissue_contact tissue_contact_node _scene:=package://tissue_contact/config/press_drag.yaml
)";

/// Where every joint state gives a wrench none may be dropped while a step takes long: a bag played too fast for this
/// machine waits here. Bounded, because nothing may grow for ever: 200 s of a 500 Hz topic, about 60 MB.
constexpr std::size_t kJointStateQueue = 100000;

Simulator makeSimulator(const ros::NodeHandle& private_node, const std::vector<std::string>& arguments,
                        PublishOptions& publish, std::vector<PlacedFrame>& frames) {
  const std::string parameter = private_node.resolveName("scene");
  std::string file;
  if (!private_node.getParam("scene", file) || file.empty()) {
    refuseUnknownParameters(private_node, nodeParameters(nullptr), arguments);  // it may be there, misspelt
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
    const std::vector<std::string> settings = textsParameter(private_node, "set");
    if (!settings.empty()) {
      ROS_INFO_STREAM("the scene is changed by "
                      << private_node.resolveName("set") << ": " << listOf(settings)
                      << ". On the parameter server it stays in force for later starts, until rosparam delete");
    }
    scene = loadScene(file, packagePath, settings, [&](const YamlMap& sections) { publish = parsePublish(sections); });
  } catch (const std::exception& error) {
    throw naming_file(error);
  }
  refuseUnknownParameters(private_node, nodeParameters(&scene), arguments);
  try {
    SceneEnvironment environment = nodeEnvironment(private_node, scene.world_frame);
    environment.frame_pose = [&frames, look_up = std::move(environment.frame_pose)](const std::string& frame) {
      Pose X_WF = look_up(frame);
      const auto is_it = [&frame](const PlacedFrame& placed) { return placed.name == frame; };
      if (std::none_of(frames.begin(), frames.end(), is_it)) frames.push_back({frame, X_WF});
      return X_WF;
    };
    return {scene, environment};
  } catch (const std::exception& error) {
    throw naming_file(error);
  }
}

/// By the node's own handle: of a nodelet with its own names and remappings, not its manager's.
std::vector<std::string> resolvedNames(const ros::NodeHandle& node, std::vector<std::string> topics) {
  for (std::string& topic : topics) topic = node.resolveName(topic);
  return topics;
}

}  // namespace

Node::Node(const ros::NodeHandle& node, const ros::NodeHandle& private_node, const std::string& name,
           const std::vector<std::string>& arguments)
    : private_node_(private_node),
      simulator_(makeSimulator(private_node_, arguments, publish_, placed_frames_)),
      player_(simulator_),
      inbox_(kJointStateQueue),
      health_(simulator_, player_, inbox_, resolvedNames(node, player_.topics())),
      outputs_(private_node_, simulator_, player_, publish_, [this](Status& status) { health_.addTo(status); }),
      tuning_(private_node_, {simulator_.scene(), publish_}),
      stepper_(simulator_, player_, inbox_, outputs_, health_, tuning_, ros::Time::isSimTime()),
      services_(stepper_),
      receiver_(inbox_, node),
      updater_(node, private_node, name) {
  for (const Advice& advice : simulator_.advice()) {
    if (advice.is_warning) {
      ROS_WARN_STREAM("advisor: " << advice.text);
    } else {
      ROS_INFO_STREAM("advisor: " << advice.text);
    }
  }
  stepper_.setMoreMayCome([this] { return receiver_.anyPublishes(); });
  health_.setPublishers([this](int topic) { return receiver_.publishers(topic); });
  updater_.setHardwareID("none");
  updater_.add("tissue contact", [this](diagnostic_updater::DiagnosticStatusWrapper& status) {
    health_.fill(receiver_.missing(), status);
  });
  if (!placed_frames_.empty()) {
    frames_ = std::make_unique<FrameWatch>(node, placed_frames_, simulator_.scene().world_frame);
    updater_.add("tf frames", [this](diagnostic_updater::DiagnosticStatusWrapper& status) { frames_->fill(status); });
  }
  updater_.add("ROS master", [this](diagnostic_updater::DiagnosticStatusWrapper& status) { master_.fill(status); });
}

void Node::start() {
  outputs_.start([this] { inbox_.wake(); });
  tuning_.start([this] { inbox_.wake(); });
  stepper_.start();
  receiver_.start(player_.topics());
  services_.start(private_node_);
  loggers_ = advertiseLoggers(private_node_);
  std::vector<std::string> services = services_.names();
  services.push_back(tuning_.serviceName());
  services.push_back(loggers_.getService());  // of a nodelet, beside those of its manager
  master_.start(services);
  diagnostics_thread_ = std::thread([this] { tellDiagnostics(); });
}

void Node::stop() {
  master_.stop();  // before what it would register again is unregistered
  tuning_.stop();
  stepper_.stop();
  services_.stop();
  receiver_.stop();
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

namespace {

/// Until the process is asked to end, or the node has to.
/// @return exit code.
int runUntilAsked(ShutdownGuard& guard, const std::vector<std::string>& arguments) {
  Node node(ros::NodeHandle(), ros::NodeHandle("~"), ros::this_node::getName(), arguments);
  const auto no_more_words = [&guard](Node* /*node*/) { guard.setLastWords(nullptr); };
  const std::unique_ptr<Node, decltype(no_more_words)> words_of(&node, no_more_words);
  guard.setLastWords([&node] {
    node.tellCounts();
    ros::shutdown();  // so that the master forgets us
  });
  node.start();
  constexpr double kWakeUp = 0.05;  // s: how long a signal may go unseen
  while (ros::ok() && !guard.asked() && !node.failed()) {
    ros::getGlobalCallbackQueue()->callAvailable(ros::WallDuration(kWakeUp));
  }
  if (!node.failed()) guard.ask();  // rosnode kill: nothing may hang then either
  node.stop();
  node.tellCounts();
  return node.failed() ? 1 : 0;
}

}  // namespace

int runNode(int argc, char** argv) {
  // Before anything of ROS, which would wait for a master.
  try {
    if (asksForHelp(argc, argv)) {
      std::cout << kNodeUsage;
      requireWritten(std::cout);
      return 0;
    }
  } catch (const std::exception& error) {
    ROS_FATAL_STREAM(error.what());
    return 1;
  }
  ShutdownGuard guard;
  const std::vector<std::string> arguments = privateArguments(argc, argv);
  int code = 1;
  try {
    startRos(argc, argv, "tissue_contact");
    const ros::NodeHandle keep_alive;  // so that the fatal message still reaches /rosout
    try {
      code = runUntilAsked(guard, arguments);
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
