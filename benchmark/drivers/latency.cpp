// The two programs of benchmark/drivers/latency, which starts them.
//   latency --echo                     a bare node: a WrenchStamped for every joint state, nothing else
//   latency --seconds S --rate-hz F    joint states of a probe that presses and drags; table of publish -> wrench received
#include <diagnostic_msgs/DiagnosticArray.h>
#include <dynamic_reconfigure/Config.h>
#include <geometry_msgs/WrenchStamped.h>
#include <ros/callback_queue.h>
#include <ros/ros.h>
#include <sensor_msgs/JointState.h>
#include <tf2_msgs/TFMessage.h>
#include <visualization_msgs/MarkerArray.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <deque>
#include <mutex>
#include <stdexcept>
#include <string>
#include <thread>
#include <unordered_map>
#include <vector>

#include "tissue_contact/Changes.h"
#include "tissue_contact/ContactArray.h"
#include "tissue_contact/Status.h"
#include "tissue_contact/TissueMesh.h"
#include "tissue_contact/TissueTopology.h"
#include "tissue_contact/core/command_line.h"

namespace {

using Clock = std::chrono::steady_clock;

constexpr const char* kJoints = "/probe/joint_states";
constexpr int kQueue = 10000;

const ros::TransportHints kHints = ros::TransportHints().tcpNoDelay();

int echo(int argc, char** argv) {
  ros::init(argc, argv, "latency_echo");
  ros::NodeHandle node("~");
  const ros::Publisher publisher = node.advertise<geometry_msgs::WrenchStamped>("probe/wrench", kQueue);
  const boost::function<void(const sensor_msgs::JointStateConstPtr&)> answer =
      [&](const sensor_msgs::JointStateConstPtr& joints) {
        geometry_msgs::WrenchStamped wrench;
        wrench.header.stamp = joints->header.stamp;
        publisher.publish(wrench);
      };
  const ros::Subscriber subscriber =
      node.subscribe<sensor_msgs::JointState>(kJoints, kQueue, answer, ros::VoidConstPtr(), kHints);
  ros::spin();
  return 0;
}

/// Times from publishing a joint state to receiving the wrench of its stamp.
class Latencies {
 public:
  Latencies(ros::NodeHandle& node, std::string name, const std::string& topic) : name_(std::move(name)) {
    const boost::function<void(const geometry_msgs::WrenchStampedConstPtr&)> take =
        [this](const geometry_msgs::WrenchStampedConstPtr& wrench) {
          const Clock::time_point now = Clock::now();
          const std::lock_guard<std::mutex> lock(mutex_);
          const auto sent = sent_.find(wrench->header.stamp.toNSec());
          if (sent == sent_.end()) return;
          ms_.push_back(std::chrono::duration<double, std::milli>(now - sent->second).count());
          sent_.erase(sent);
        };
    subscriber_ = node.subscribe<geometry_msgs::WrenchStamped>(topic, kQueue, take, ros::VoidConstPtr(), kHints);
  }

  bool connected() const { return subscriber_.getNumPublishers() > 0; }

  void noteSent(const ros::Time& stamp) {
    const std::lock_guard<std::mutex> lock(mutex_);
    sent_.emplace(stamp.toNSec(), Clock::now());
    ++sent_count_;
  }

  /// Older ones may have been merged into it.
  bool answered(const ros::Time& stamp) {
    const std::lock_guard<std::mutex> lock(mutex_);
    return sent_.count(stamp.toNSec()) == 0;
  }

  std::size_t count() {
    const std::lock_guard<std::mutex> lock(mutex_);
    return ms_.size();
  }

  void print() {
    const std::lock_guard<std::mutex> lock(mutex_);
    std::sort(ms_.begin(), ms_.end());
    const auto quantile = [&](double q) {
      return ms_.empty() ? std::nan("") : ms_[static_cast<std::size_t>(q * static_cast<double>(ms_.size() - 1))];
    };
    std::printf("%-16s %7ld %8zu %9.3f %9.3f %9.3f\n", name_.c_str(), sent_count_, ms_.size(), quantile(0.5),
                quantile(0.99), quantile(1.0));
  }

 private:
  std::string name_;
  std::mutex mutex_;
  std::unordered_map<std::uint64_t, Clock::time_point> sent_;  ///< and not answered
  long sent_count_ = 0;
  std::vector<double> ms_;
  ros::Subscriber subscriber_;
};

/// What else a user looks at: counted, by a thread of its own.
class Others {
 public:
  Others() : spinner_(1, &queue_) {
    node_.setCallbackQueue(&queue_);
    count<geometry_msgs::WrenchStamped>("/tissue_contact/probe/body/measured_cf");  // hasAll() takes the first two
    count<geometry_msgs::WrenchStamped>("/tissue_contact/probe/spatial/measured_cf");
    count<tissue_contact::TissueTopology>("/tissue_contact/block/topology");
    count<tissue_contact::TissueMesh>("/tissue_contact/block/mesh");
    count<visualization_msgs::MarkerArray>("/tissue_contact/markers");
    count<tissue_contact::ContactArray>("/tissue_contact/contacts");
    count<tissue_contact::Status>("/tissue_contact/status");
    count<tissue_contact::Changes>("/tissue_contact/changes");
    count<dynamic_reconfigure::Config>("/tissue_contact/parameter_updates");
    count<tf2_msgs::TFMessage>("/tf");
    count<diagnostic_msgs::DiagnosticArray>("/diagnostics");
    count<geometry_msgs::WrenchStamped>("/device/servo_cf");
    spinner_.start();
  }

  bool connected() const {
    return std::all_of(topics_.begin(), topics_.end(),
                       [](const Topic& topic) { return topic.subscriber.getNumPublishers() > 0; });
  }

  /// Whether CRTK's wrenches came, as many as the others: they leave a moment later.
  bool hasAll(std::size_t wrenches) const {
    return topics_[0].count >= static_cast<long>(wrenches) && topics_[1].count >= static_cast<long>(wrenches);
  }

  void print() const {
    for (const Topic& topic : topics_) std::printf("beside %-44s %8ld\n", topic.name.c_str(), topic.count.load());
  }

 private:
  struct Topic {
    std::string name;
    std::atomic<long> count{0};
    ros::Subscriber subscriber;
  };

  template <typename Message>
  void count(const std::string& name) {
    Topic& topic = topics_.emplace_back();
    topic.name = name;
    const boost::function<void(const boost::shared_ptr<const Message>&)> take =
        [&topic](const boost::shared_ptr<const Message>&) { ++topic.count; };
    topic.subscriber = node_.subscribe<Message>(name, kQueue, take);
  }

  ros::CallbackQueue queue_;
  ros::NodeHandle node_;
  std::deque<Topic> topics_;
  ros::AsyncSpinner spinner_;
};

sensor_msgs::JointState jointsAt(double time_s) {
  constexpr double kTurn = 2.0 * 3.14159265358979;
  sensor_msgs::JointState joints;
  joints.name = {"x", "y", "z"};
  joints.position = {0.004 * std::sin(kTurn * time_s), 0.0, -0.0125 + 0.0025 * std::cos(kTurn * 0.5 * time_s)};
  joints.header.stamp = ros::Time::now();
  return joints;
}

int measure(int argc, char** argv, double seconds, double rate_hz) {
  ros::init(argc, argv, "latency_measure", ros::init_options::AnonymousName);
  ros::NodeHandle node;
  const ros::Publisher publisher = node.advertise<sensor_msgs::JointState>(kJoints, kQueue);
  Latencies ours(node, "tissue_contact", "/tissue_contact/probe/wrench");
  Latencies bare(node, "bare echo", "/latency_echo/probe/wrench");
  const Others others;
  ros::AsyncSpinner spinner(1);
  spinner.start();
  while (ros::ok() &&
         !(ours.connected() && bare.connected() && others.connected() && publisher.getNumSubscribers() >= 2)) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  const auto period = std::chrono::duration_cast<Clock::duration>(std::chrono::duration<double>(1.0 / rate_hz));
  const Clock::time_point start = Clock::now();
  const auto states = static_cast<long>(seconds * rate_hz);
  ros::Time last;
  for (long i = 0; i < states && ros::ok(); ++i) {
    std::this_thread::sleep_until(start + i * period);
    const sensor_msgs::JointState joints = jointsAt(static_cast<double>(i) / rate_hz);
    last = joints.header.stamp;
    ours.noteSent(joints.header.stamp);
    bare.noteSent(joints.header.stamp);
    publisher.publish(joints);
  }
  constexpr std::chrono::seconds kPatience(30);
  const Clock::time_point end = Clock::now() + kPatience;
  while (Clock::now() < end && !(ours.answered(last) && bare.answered(last) && others.hasAll(ours.count()))) {
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  std::printf("%-16s %7s %8s %9s %9s %9s   ms, publish -> wrench received\n", "", "sent", "answered", "p50", "p99",
              "max");
  ours.print();
  bare.print();
  others.print();
  ros::shutdown();
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    const tissue_contact::CommandLine line({argv + 1, argv + argc}, {{"--seconds", "--rate-hz"}, {"--echo"}, {}});
    if (line.has("--echo")) return echo(argc, argv);
    line.required("--seconds");
    line.required("--rate-hz");
    return measure(argc, argv, line.number("--seconds", 0.0, {0.0, 1e6, "s"}),
                   line.number("--rate-hz", 0.0, {0.0, 1e5, "Hz", "", true}));
  } catch (const std::invalid_argument& error) {
    std::fprintf(stderr, "%s; started by benchmark/drivers/latency\n", error.what());
    return 2;
  }
}
