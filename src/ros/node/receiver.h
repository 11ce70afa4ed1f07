/// @file
/// Room `ros`, private: joint states from their topics into an inbox, as they come in from the network.
#pragma once

#include <ros/callback_queue_interface.h>
#include <ros/message_event.h>
#include <ros/node_handle.h>
#include <ros/subscriber.h>
#include <rosgraph_msgs/Clock.h>
#include <sensor_msgs/JointState.h>

#include <cstdint>
#include <mutex>
#include <string>
#include <vector>

#include "ros/node/joint_state_inbox.h"
#include "ros/node/sequence_gaps.h"

namespace tissue_contact {

/// roscpp's thread that reads the connections hands each message over itself, so that no queue of roscpp's lies between,
/// which would drop without a count: what does not fit waits in the connection or is dropped, counted, by the inbox; what
/// a publisher drops shows in its numbers. With simulated time it also watches /clock: set back, it says so to the inbox.
class Receiver {
 public:
  /// @param inbox must outlive this. @param node by which names of topics are resolved.
  Receiver(JointStateInbox& inbox, const ros::NodeHandle& node) : inbox_(inbox), node_(node) {
    node_.setCallbackQueue(&at_once_);
  }
  ~Receiver() { stop(); }
  Receiver(const Receiver&) = delete;
  Receiver& operator=(const Receiver&) = delete;

  /// Subscribes. Indices into `topics` are ReceivedState::topic.
  void start(const std::vector<std::string>& topics);
  void stop();

  /// Joint states that publishers numbered in header.seq and that never came. Any thread.
  std::int64_t missing() const;
  /// Names of those heard on the topic. Any thread.
  std::string publishers(int topic) const;
  /// Whether any topic has a publisher now, or one that was killed and that the master does not know of yet. Any thread.
  bool anyPublishes() const;

 private:
  /// Calls back where roscpp would queue: in its reading thread, one at a time.
  class AtOnce : public ros::CallbackQueueInterface {
   public:
    void addCallback(const ros::CallbackInterfacePtr& callback, std::uint64_t /*owner*/) override {
      const std::lock_guard<std::mutex> lock(mutex_);
      callback->call();
    }
    void removeByID(std::uint64_t /*owner*/) override {}

   private:
    std::mutex mutex_;
  };

  void take(int topic, const ros::MessageEvent<const sensor_msgs::JointState>& event);
  void watchClock(const rosgraph_msgs::Clock& clock);

  JointStateInbox& inbox_;
  AtOnce at_once_;
  ros::NodeHandle node_;
  ros::Subscriber clock_subscriber_;
  mutable std::mutex subscribers_mutex_;
  std::vector<ros::Subscriber> subscribers_;  ///< per topic
  mutable std::mutex gaps_mutex_;
  SequenceGaps gaps_;
  // Callbacks alone.
  std::int64_t last_stamp_ns_ = 0;
  std::int64_t last_clock_ns_ = 0;
};

}  // namespace tissue_contact
