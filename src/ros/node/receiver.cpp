#include "ros/node/receiver.h"

#include <ros/time.h>
#include <ros/transport_hints.h>

#include <algorithm>
#include <cmath>
#include <cstdlib>

#include "ros/conversions.h"
#include "tissue_contact/ros/environment.h"

namespace tissue_contact {
namespace {

/// Of roscpp: each message is taken from it as it is put in.
constexpr int kRoscppQueue = 1;

}  // namespace

void Receiver::start(const std::vector<std::string>& topics) {
  const ros::TransportHints hints = ros::TransportHints().tcpNoDelay();
  if (ros::Time::isSimTime()) {
    clock_subscriber_ = node_.subscribe("/clock", kRoscppQueue, &Receiver::watchClock, this, hints);
  }
  for (std::size_t i = 0; i < topics.size(); ++i) {
    const boost::function<void(const ros::MessageEvent<const sensor_msgs::JointState>&)> callback =
        [this, i](const ros::MessageEvent<const sensor_msgs::JointState>& event) { take(static_cast<int>(i), event); };
    const ros::Subscriber subscriber =
        node_.subscribe<sensor_msgs::JointState>(topics[i], kRoscppQueue, callback, ros::VoidConstPtr(), hints);
    const std::lock_guard<std::mutex> lock(subscribers_mutex_);
    subscribers_.push_back(subscriber);
  }
}

void Receiver::stop() {
  clock_subscriber_.shutdown();
  std::vector<ros::Subscriber> ended;  // outside the lock: this waits for callbacks
  const std::lock_guard<std::mutex> lock(subscribers_mutex_);
  ended.swap(subscribers_);
}

bool Receiver::anyPublishes() const {
  const std::lock_guard<std::mutex> lock(subscribers_mutex_);
  return std::any_of(subscribers_.begin(), subscribers_.end(),
                     [](const ros::Subscriber& subscriber) { return subscriber.getNumPublishers() > 0; });
}

std::int64_t Receiver::missing() const {
  const std::lock_guard<std::mutex> lock(gaps_mutex_);
  return gaps_.missing();
}

std::string Receiver::publishers(int topic) const {
  const std::lock_guard<std::mutex> lock(gaps_mutex_);
  return gaps_.publishers(topic);
}

void Receiver::take(int topic, const ros::MessageEvent<const sensor_msgs::JointState>& event) {
  const sensor_msgs::JointState& message = *event.getConstMessage();
  {
    const std::lock_guard<std::mutex> lock(gaps_mutex_);
    gaps_.note(topic, event.getPublisherName(), message.header.seq);
  }
  ReceivedState state;
  state.topic = topic;
  state.sample = toSample(message);
  state.received_s = steadySeconds();
  state.age_s = ros::WallTime::now().toSec() - message.header.stamp.toSec();
  last_stamp_ns_ = state.sample.stamp_ns;
  inbox_.put(std::move(state));
}

/// Joint states and /clock come over connections of their own, so the first joint state after the jump may be here before
/// it: then their stamps tell of it themselves, and telling it twice would start the scene twice.
void Receiver::watchClock(const rosgraph_msgs::Clock& clock) {
  constexpr std::int64_t kJitter_ns = 10'000'000;  // several publishers; a recording that starts over goes farther back
  const auto now_ns = static_cast<std::int64_t>(clock.clock.toNSec());
  const bool is_still_before_jump = std::abs(last_stamp_ns_ - last_clock_ns_) < std::abs(last_stamp_ns_ - now_ns);
  if (now_ns < last_clock_ns_ - kJitter_ns && is_still_before_jump) inbox_.noteRestart();
  last_clock_ns_ = now_ns;
}

}  // namespace tissue_contact
