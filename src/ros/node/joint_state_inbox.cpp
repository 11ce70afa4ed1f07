#include "ros/node/joint_state_inbox.h"

#include <chrono>
#include <string>
#include <utility>

namespace tissue_contact {
namespace {

std::size_t bytesOf(const ReceivedState& state) {
  std::size_t bytes = sizeof(ReceivedState) + state.sample.positions.size() * sizeof(double);
  for (const std::string& name : state.sample.names) bytes += sizeof(std::string) + name.size();
  return bytes;
}

}  // namespace

void JointStateInbox::put(ReceivedState state) {
  const std::lock_guard<std::mutex> lock(mutex_);
  ++counts_.received;
  counts_.newest_stamp_ns = state.sample.stamp_ns;
  const auto topic = static_cast<std::size_t>(state.topic);
  if (topic >= heard_s_.size()) heard_s_.resize(topic + 1);
  heard_s_[topic] = state.received_s;
  state.after_restart = std::exchange(restarted_, false);
  bytes_ += bytesOf(state);
  waiting_.push_back(std::move(state));
  while (waiting_.size() > most_ || (bytes_ > most_bytes_ && waiting_.size() > 1)) dropOldest();
  arrived_.notify_one();
}

void JointStateInbox::dropOldest() {
  const bool after_restart = waiting_.front().after_restart;
  bytes_ -= bytesOf(waiting_.front());
  waiting_.pop_front();
  waiting_.front().after_restart |= after_restart;
  ++counts_.dropped;
}

void JointStateInbox::noteRestart() {
  const std::lock_guard<std::mutex> lock(mutex_);
  restarted_ = true;
}

std::optional<ReceivedState> JointStateInbox::take() {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (waiting_.empty()) return std::nullopt;
  bytes_ -= bytesOf(waiting_.front());
  std::optional<ReceivedState> oldest = std::move(waiting_.front());
  waiting_.pop_front();
  return oldest;
}

void JointStateInbox::wait() {
  std::unique_lock<std::mutex> lock(mutex_);
  arrived_.wait(lock, [this] { return woken_ || !waiting_.empty(); });
  woken_ = false;
}

bool JointStateInbox::wait(double most_s) {
  std::unique_lock<std::mutex> lock(mutex_);
  const bool came =
      arrived_.wait_for(lock, std::chrono::duration<double>(most_s), [this] { return woken_ || !waiting_.empty(); });
  woken_ = false;
  return came;
}

void JointStateInbox::wake() {
  const std::lock_guard<std::mutex> lock(mutex_);
  woken_ = true;
  arrived_.notify_one();
}

JointStateInbox::Counts JointStateInbox::counts() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  Counts counts = counts_;
  counts.waiting = waiting_.size();
  if (!waiting_.empty()) counts.oldest_received_s = waiting_.front().received_s;
  return counts;
}

std::vector<std::optional<double>> JointStateInbox::heard(std::size_t topics) const {
  const std::lock_guard<std::mutex> lock(mutex_);
  std::vector<std::optional<double>> heard_s = heard_s_;
  heard_s.resize(topics);
  return heard_s;
}

}  // namespace tissue_contact
