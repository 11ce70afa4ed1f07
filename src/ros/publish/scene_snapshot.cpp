#include "ros/publish/scene_snapshot.h"

#include <utility>

namespace tissue_contact {

void takeSnapshot(const Simulator& simulator, std::int64_t stamp_ns, SceneSnapshot& snapshot) {
  snapshot.stamp_ns = stamp_ns;
  snapshot.step = simulator.stepCount();
  if (snapshot.mesh || snapshot.markers) {
    snapshot.positions.resize(simulator.tissues().size());
    for (std::size_t t = 0; t < snapshot.positions.size(); ++t) {
      snapshot.positions[t] = simulator.positions(static_cast<int>(t));
    }
  }
  if (snapshot.contact_array || snapshot.markers) snapshot.contacts = simulator.contacts();
  if (snapshot.markers) {
    snapshot.link_poses.resize(simulator.instruments().size());
    for (std::size_t i = 0; i < snapshot.link_poses.size(); ++i) {
      snapshot.link_poses[i] = simulator.linkPoses(static_cast<int>(i));
    }
  }
}

std::unique_ptr<SceneSnapshot> SnapshotQueue::buffer() {
  const std::lock_guard<std::mutex> lock(mutex_);
  if (unused_.empty()) return std::make_unique<SceneSnapshot>();
  std::unique_ptr<SceneSnapshot> snapshot = std::move(unused_.back());
  unused_.pop_back();
  snapshot->mesh = snapshot->contact_array = snapshot->markers = snapshot->with_status = false;
  return snapshot;
}

void SnapshotQueue::put(std::unique_ptr<SceneSnapshot> snapshot) {
  const std::lock_guard<std::mutex> lock(mutex_);
  waiting_.push_back(std::move(snapshot));
  if (waiting_.size() > most_) {
    unused_.push_back(std::move(waiting_.front()));
    waiting_.pop_front();
    ++dropped_;
  }
  changed_.notify_one();
}

std::unique_ptr<SceneSnapshot> SnapshotQueue::take() {
  std::unique_lock<std::mutex> lock(mutex_);
  changed_.wait(lock, [this] { return closed_ || !waiting_.empty(); });
  if (closed_) return nullptr;
  std::unique_ptr<SceneSnapshot> snapshot = std::move(waiting_.front());
  waiting_.pop_front();
  return snapshot;
}

void SnapshotQueue::recycle(std::unique_ptr<SceneSnapshot> snapshot) {
  const std::lock_guard<std::mutex> lock(mutex_);
  unused_.push_back(std::move(snapshot));
}

void SnapshotQueue::close() {
  const std::lock_guard<std::mutex> lock(mutex_);
  closed_ = true;
  changed_.notify_all();
}

std::int64_t SnapshotQueue::dropped() const {
  const std::lock_guard<std::mutex> lock(mutex_);
  return dropped_;
}

}  // namespace tissue_contact
