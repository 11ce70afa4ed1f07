#include "tissue_contact/ros/environment.h"

#include <ros/callback_queue.h>
#include <ros/console.h>
#include <ros/node_handle.h>
#include <ros/subscriber.h>
#include <rospack/rospack.h>
#include <tf2/buffer_core.h>
#include <tf2_msgs/TFMessage.h>

#include <array>
#include <chrono>
#include <cstdint>
#include <iostream>
#include <limits>
#include <memory>
#include <sstream>
#include <stdexcept>
#include <vector>

#include "ros/bag/bag_frames.h"
#include "ros/conversions.h"
#include "ros/frame_motion.h"
#include "ros/parameter.h"
#include "tissue_contact/core/cache_folder.h"
#include "tissue_contact/core/range.h"
#include "tissue_contact/core/read_file.h"
#include "tissue_contact/instrument/parse_urdf.h"

namespace tissue_contact {
namespace {

constexpr Range kTimeoutRange{0.0, 1e6, "s"};

std::string urdfParameter(const ros::NodeHandle& private_node, const std::string& parameter) {
  const std::string tried_first = private_node.resolveName(parameter);
  std::string name = tried_first;
  if (!private_node.hasParam(parameter) && !ros::NodeHandle().searchParam(parameter, name)) {
    throw std::invalid_argument("parameter '" + parameter + "' is not set (tried " + tried_first +
                                " and every namespace up to /" + parameter + "); load the URDF with <param name=\"" +
                                parameter + "\" textfile=\"...\"/>");
  }
  std::string text;
  if (!private_node.getParam(name, text)) {
    throw std::invalid_argument("parameter '" + name + "' is not a string; it must hold the text of a URDF");
  }
  return text;
}

void requireUrdfParameter(const Scene& scene) {
  if (takesUrdfFromParameter(scene)) return;
  throw UnusedUrdf("--urdf would change nothing: no instrument of scene '" + scene.file +
                   "' takes its URDF from a parameter; leave --urdf out, or have the scene say robot_description in "
                   "place of urdf");
}

/// Waits for a frame by the wall clock: with simulated time nothing may be playing yet. Not with tf2's listener, which ends the process on
/// stamps that are out of its range.
Pose waitForFrame(const std::string& frame, const std::string& world_frame, double timeout_s) {
  tf2::BufferCore buffer;
  ros::CallbackQueue queue;  // no thread spins yet
  ros::NodeHandle node;
  node.setCallbackQueue(&queue);
  const auto listen = [&](const std::string& topic, bool is_static) {
    constexpr std::uint32_t kQueue = 100;
    return node.subscribe<tf2_msgs::TFMessage>(
        topic, kQueue, [&buffer, is_static](const tf2_msgs::TFMessageConstPtr& message) {
          for (const geometry_msgs::TransformStamped& transform : message->transforms)
            takeTransform(transform, is_static, buffer);
        });
  };
  const std::array<ros::Subscriber, 2> subscribers = {listen("/tf_static", true), listen("/tf", false)};
  const double start_s = steadySeconds();
  for (std::string why; !buffer.canTransform(world_frame, frame, ros::Time(0), &why); why.clear()) {
    if (!ros::ok() || steadySeconds() - start_s >= timeout_s) {
      std::ostringstream text;
      text << "tf frame '" << frame << "' has no transform to the world frame '" << world_frame << "' after "
           << timeout_s << " s (" << why << "); publish it, or give ~tf_timeout_s more time";
      throw std::invalid_argument(text.str());
    }
    queue.callAvailable(ros::WallDuration(0.01));
  }
  return toPose(buffer.lookupTransform(world_frame, frame, ros::Time(0)).transform);
}

}  // namespace

double steadySeconds() {
  static const auto start = std::chrono::steady_clock::now();
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
}

std::string packagePath(const std::string& package) {
  // Not ros::package::getPath(): it prints two lines of its own before the caller's message says what is wrong.
  rospack::Rospack rospack;
  rospack.setQuiet(true);
  std::vector<std::string> search_path;
  rospack.getSearchPathFromEnv(search_path);
  rospack.crawl(search_path, false);
  std::string path;
  return rospack.find(package, path) ? path : std::string();
}

SceneEnvironment nodeEnvironment(const ros::NodeHandle& private_node, const std::string& world_frame) {
  const double timeout_s = numberParameter(private_node, "tf_timeout_s", 10.0, kTimeoutRange);
  SceneEnvironment environment;
  environment.package_path = packagePath;
  environment.clock = steadySeconds;
  environment.meshes = {userCacheDirectory(), [](const std::string& line) { ROS_INFO_STREAM(line); }, steadySeconds};
  environment.urdf_text = [private_node](const std::string& parameter) {
    return urdfParameter(private_node, parameter);
  };
  environment.frame_pose = [world_frame, timeout_s](const std::string& frame) {
    return waitForFrame(frame, world_frame, timeout_s);
  };
  return environment;
}

SceneEnvironment bagEnvironment(const Scene& scene, const std::string& bag_file, const std::string& urdf_file) {
  if (!urdf_file.empty()) requireUrdfParameter(scene);
  SceneEnvironment environment;
  environment.package_path = packagePath;
  environment.clock = steadySeconds;
  environment.meshes = {userCacheDirectory(),
                        [](const std::string& line) { std::cerr << "tissue_contact_replay: " << line << "\n"; },
                        steadySeconds};
  environment.urdf_text = [urdf_file](const std::string& parameter) {
    if (urdf_file.empty()) {
      throw std::invalid_argument("the scene takes a URDF from parameter '" + parameter +
                                  "', but a bag holds no parameters; give its text with --urdf FILE");
    }
    return readFile(urdf_file, "URDF file", kMaxUrdfBytes);
  };
  environment.frame_pose = [bag_file, world_frame = scene.world_frame](const std::string& frame) {
    return frameInBag(frame, world_frame, bag_file);
  };
  return environment;
}

}  // namespace tissue_contact
