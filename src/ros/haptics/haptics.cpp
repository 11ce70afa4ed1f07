#include "ros/haptics/haptics.h"

#include <geometry_msgs/WrenchStamped.h>
#include <ros/callback_queue.h>
#include <ros/console.h>
#include <ros/init.h>
#include <ros/node_handle.h>
#include <ros/service_server.h>
#include <ros/spinner.h>
#include <ros/xmlrpc_manager.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <exception>
#include <iostream>
#include <mutex>
#include <string>
#include <thread>
#include <utility>
#include <vector>

#include "ros/conversions.h"
#include "ros/haptics/haptic_output.h"
#include "ros/node/logger_service.h"
#include "ros/node/master_watch.h"
#include "ros/node/private_parameters.h"
#include "ros/node/shutdown_guard.h"
#include "ros/parameter.h"
#include "tissue_contact/core/range.h"
#include "tissue_contact/core/whole_file.h"

namespace tissue_contact {
namespace {

constexpr const char* kHapticsUsage =
    R"(usage: rosrun tissue_contact tissue_contact_haptics wrench:=TOPIC servo_cf:=TOPIC [_parameter:=value]

Drives a haptic device: the wrench on an instrument, scaled and bounded, at a fixed rate; zero when none comes. Needs a ROS master.

subscribed topic
  wrench     geometry_msgs/WrenchStamped, such as /tissue_contact/PSM1/wrench
published topic
  servo_cf   geometry_msgs/WrenchStamped, such as /MTMR/body/servo_cf

private parameters (doc/haptics.md)
  ~rate_hz        commands per second; default 1000
  ~force_scale    newtons of the device per newton, negative for body/measured_cf and the like; default 1
  ~torque_scale   default 0
  ~max_force_n    longer forces are cut to it; default 2
  ~max_torque_nm  default 0.05
  ~stale_after_s  zero when the newest wrench came longer ago; default 0.05
  ~roll_rad, ~pitch_rad, ~yaw_rad   of the wrenches' axes in those of the device; default 0
  ~frame_id       of the commands; default: that of the wrenches
)";

const std::vector<std::string> kNames = {"force_scale", "frame_id", "max_force_n",   "max_torque_nm", "pitch_rad",
                                         "rate_hz",     "roll_rad", "stale_after_s", "torque_scale",  "yaw_rad"};

// Far beyond any device; the bounds on force and torque are what protects the hand.
constexpr Range kDeviceRate{1.0, 10000.0, "Hz"};
constexpr Range kScale{-1000.0, 1000.0};
constexpr Range kForce{0.0, 100.0, "N", "", true};
constexpr Range kTorque{0.0, 10.0, "N m", "", true};
constexpr Range kStale{0.001, 10.0, "s"};
constexpr Range kAngle{-6.3, 6.3, "rad"};

/// How long zeros go on once it is asked to stop: for a device that reads its commands now and then. Less than ShutdownGuard's grace.
constexpr std::chrono::milliseconds kFarewell(100);
constexpr std::chrono::seconds kPatience(10);  // for a first wrench

using Clock = std::chrono::steady_clock;

std::int64_t nowNs() {
  return std::chrono::duration_cast<std::chrono::nanoseconds>(Clock::now().time_since_epoch()).count();
}

/// rosnode kill: roscpp's own answer closes the publishers before a zero could leave.
std::atomic<bool> g_killed{false};

void onKill(XmlRpc::XmlRpcValue& /*parameters*/, XmlRpc::XmlRpcValue& result) {
  g_killed = true;
  result = ros::xmlrpc::responseInt(1, "", 0);
}

HapticOptions readOptions(const ros::NodeHandle& node) {
  HapticOptions options;
  options.force_scale = numberParameter(node, "force_scale", options.force_scale, kScale);
  options.torque_scale = numberParameter(node, "torque_scale", options.torque_scale, kScale);
  options.max_force_n = numberParameter(node, "max_force_n", options.max_force_n, kForce);
  options.max_torque_nm = numberParameter(node, "max_torque_nm", options.max_torque_nm, kTorque);
  options.stale_after_s = numberParameter(node, "stale_after_s", options.stale_after_s, kStale);
  const auto turn = [&](const char* name, const Vector3& axis) {
    return Eigen::AngleAxisd(numberParameter(node, name, 0.0, kAngle), axis);
  };
  options.R_DW =
      (turn("yaw_rad", Vector3::UnitZ()) * turn("pitch_rad", Vector3::UnitY()) * turn("roll_rad", Vector3::UnitX()))
          .toRotationMatrix();
  return options;
}

/// Three threads: roscpp's takes wrenches, the main one publishes by the clock, MasterWatch's registers again.
class Haptics {
 public:
  /// @param arguments see privateArguments().
  explicit Haptics(const std::vector<std::string>& arguments)
      : private_node_("~"),
        output_(readOptions(private_node_)),
        rate_hz_(numberParameter(private_node_, "rate_hz", 1000.0, kDeviceRate)),
        frame_(textParameter(private_node_, "frame_id", "")) {
    refuseUnknownParameters(private_node_, {kNames, {}, true}, arguments);
  }

  void run(const ShutdownGuard& guard) {
    const ros::ServiceServer loggers = advertiseLoggers(private_node_);
    publisher_ = node_.advertise<geometry_msgs::WrenchStamped>("servo_cf", 1);
    // The newest alone: what has waited is not to be felt.
    const ros::Subscriber wrenches =
        node_.subscribe("wrench", 1, &Haptics::take, this, ros::TransportHints().tcpNoDelay());
    ros::AsyncSpinner spinner(1);
    spinner.start();
    master_.start({});
    const Clock::duration period =
        std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(1.0 / rate_hz_));
    Clock::time_point next = Clock::now();
    const Clock::time_point patient_until = next + kPatience;
    Clock::time_point end = Clock::time_point::max();
    while (ros::ok() && next < end) {
      const bool asked = guard.asked() || g_killed;
      if (asked && end == Clock::time_point::max()) end = std::max(next, Clock::now()) + kFarewell;
      publish(asked);
      if (!asked && !heard_ && next > patient_until) {
        heard_ = true;  // told once
        ROS_WARN_STREAM(
            "no wrench yet on "
            << wrenches.getTopic() << ", which has " << wrenches.getNumPublishers()
            << " publishers: commands are zero. Is it the topic, wrench:=/tissue_contact/NAME/wrench, and do "
               "joint states come?");
      }
      next = std::max(next + period, Clock::now());  // a late one is not made up for by a burst
      std::this_thread::sleep_until(std::min(next, end));
    }
    master_.stop();  // before what it would register again is unregistered
  }

 private:
  void take(const geometry_msgs::WrenchStamped& message) {
    const geometry_msgs::Vector3& force = message.wrench.force;
    const geometry_msgs::Vector3& torque = message.wrench.torque;
    heard_ = true;
    std::unique_lock<std::mutex> lock(mutex_);
    output_.take({{force.x, force.y, force.z}, {torque.x, torque.y, torque.z}}, nowNs());
    if (frame_.empty()) command_.header.frame_id = message.header.frame_id;
    const auto not_finite = output_.notFinite();
    const bool is_new = not_finite > std::exchange(told_not_finite_, not_finite);
    lock.unlock();  // a log that blocks must not hold the last force
    if (is_new) {
      ROS_WARN_STREAM_THROTTLE(10.0, "wrenches that are not finite command zero: " << not_finite << " so far");
    }
  }

  void publish(bool zero) {
    const std::lock_guard<std::mutex> lock(mutex_);
    if (!frame_.empty()) command_.header.frame_id = frame_;
    const Wrench wrench = zero ? Wrench() : output_.command(nowNs());
    command_.header.stamp = ros::Time::now();
    command_.wrench.force = toVector(wrench.force);
    command_.wrench.torque = toVector(wrench.torque);
    publisher_.publish(command_);
  }

  ros::NodeHandle node_;
  ros::NodeHandle private_node_;
  ros::Publisher publisher_;
  MasterWatch master_;
  std::atomic<bool> heard_{false};  ///< a wrench, or that none came was told
  std::mutex mutex_;                ///< guards what follows
  HapticOutput output_;
  geometry_msgs::WrenchStamped command_;
  std::int64_t told_not_finite_ = 0;
  // Const once made.
  double rate_hz_;
  std::string frame_;
};

}  // namespace

int runHaptics(int argc, char** argv) {
  try {
    if (asksForHelp(argc, argv)) {
      std::cout << kHapticsUsage;
      requireWritten(std::cout);
      return 0;
    }
  } catch (const std::exception& error) {
    ROS_FATAL_STREAM(error.what());
    return 1;
  }
  ShutdownGuard guard;
  const std::vector<std::string> arguments = privateArguments(argc, argv);
  try {
    startRos(argc, argv, "haptics");
  } catch (const std::exception& error) {
    ROS_FATAL_STREAM(error.what());
    return 1;
  }
  ros::XMLRPCManager::instance()->unbind("shutdown");
  ros::XMLRPCManager::instance()->bind("shutdown", onKill);
  int code = 0;
  try {
    const ros::NodeHandle keep_alive;  // so that the fatal message still reaches /rosout
    try {
      Haptics(arguments).run(guard);
    } catch (const std::exception& error) {
      ROS_FATAL_STREAM(error.what());
      code = 1;
    }
  } catch (const std::exception& error) {
    ROS_FATAL_STREAM(error.what());
    code = 1;
  }
  ros::shutdown();
  return code;
}

}  // namespace tissue_contact
