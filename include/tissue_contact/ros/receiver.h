/// @file
/// Room `ros`: joint states from their topics into an inbox, by a thread that does nothing else.
#pragma once

#include <ros/callback_queue.h>
#include <ros/message_event.h>
#include <ros/node_handle.h>
#include <ros/spinner.h>
#include <ros/subscriber.h>
#include <rosgraph_msgs/Clock.h>
#include <sensor_msgs/JointState.h>

#include <atomic>
#include <cstdint>
#include <string>
#include <vector>

#include "tissue_contact/ros/joint_state_inbox.h"
#include "tissue_contact/ros/sequence_gaps.h"

namespace tissue_contact {

/// Its one thread copies messages as they come, so roscpp's own queues, which drop without a count, never fill. With
/// simulated time it also watches /clock: set back, it says so to the inbox.
class Receiver {
 public:
  /// @param inbox must outlive this.
  explicit Receiver(JointStateInbox& inbox) : inbox_(inbox), spinner_(1, &queue_) { node_.setCallbackQueue(&queue_); }
  ~Receiver() { stop(); }
  Receiver(const Receiver&) = delete;
  Receiver& operator=(const Receiver&) = delete;

  /// Subscribes. Indices into `topics` are ReceivedState::topic.
  void start(const std::vector<std::string>& topics);
  void stop();

  /// Joint states that publishers numbered in header.seq and that never came. Any thread.
  std::int64_t missing() const { return missing_; }

 private:
  void take(int topic, const ros::MessageEvent<const sensor_msgs::JointState>& event);
  void watchClock(const rosgraph_msgs::Clock& clock);

  JointStateInbox& inbox_;
  ros::CallbackQueue queue_;
  ros::NodeHandle node_;
  ros::AsyncSpinner spinner_;
  std::vector<ros::Subscriber> subscribers_;
  // All below but missing_: the spinner's thread alone.
  SequenceGaps gaps_;
  std::atomic<std::int64_t> missing_{0};
  std::int64_t last_stamp_ns_ = 0;
  std::int64_t last_clock_ns_ = 0;
};

}  // namespace tissue_contact
