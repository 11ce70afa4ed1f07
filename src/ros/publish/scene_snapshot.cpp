#include "ros/publish/scene_snapshot.h"

#include <utility>

#include "tissue_contact/simulation/touched_point.h"

namespace tissue_contact {
namespace {

/// Of an unrefined mesh the positions are the first of those there are.
void takeMeshes(const Simulator& simulator, std::vector<ShownMesh>& meshes, bool with_positions,
                SceneSnapshot& snapshot) {
  snapshot.revisions.resize(meshes.size());
  snapshot.positions.resize(meshes.size());
  for (std::size_t t = 0; t < meshes.size(); ++t) {
    const int tissue = static_cast<int>(t);
    snapshot.revisions[t] = meshes[t].follow(simulator.tissues()[t], simulator.meshRevision(tissue));
    if (!with_positions) continue;
    snapshot.positions[t] = simulator.positions(tissue).leftCols(snapshot.revisions[t]->nodeCount());
  }
}

}  // namespace

std::vector<ShownMesh> shownMeshes(const Simulator& simulator, PublishedMesh which) {
  std::vector<ShownMesh> meshes;
  for (const Tissue& tissue : simulator.tissues()) {
    meshes.emplace_back(tissue, simulator.meshRevision(static_cast<int>(meshes.size())), which);
  }
  return meshes;
}

void takeSnapshot(const Simulator& simulator, std::vector<ShownMesh>& meshes, std::int64_t stamp_ns,
                  SceneSnapshot& snapshot) {
  snapshot.stamp_ns = stamp_ns;
  snapshot.step = simulator.stepCount();
  const bool with_positions = snapshot.mesh || snapshot.markers;
  if (with_positions || snapshot.topologies) takeMeshes(simulator, meshes, with_positions, snapshot);
  if (snapshot.contact_array || snapshot.markers) {
    snapshot.contacts = simulator.contacts();
    for (SolvedContact& one : snapshot.contacts) one.contact.p_WC = touchedPoint(one.contact, simulator.tissues());
  }
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
  snapshot->topologies = snapshot->mesh = snapshot->contact_array = snapshot->markers = snapshot->with_status = false;
  return snapshot;
}

void SnapshotQueue::put(std::unique_ptr<SceneSnapshot> snapshot) {
  const std::lock_guard<std::mutex> lock(mutex_);
  waiting_.push_back(std::move(snapshot));
  if (waiting_.size() > most_) drop();
  changed_.notify_one();
}

/// The oldest; another waits behind it. The lock is held. A topology is told once only, and whoever subscribes later needs it too.
void SnapshotQueue::drop() {
  std::unique_ptr<SceneSnapshot> oldest = std::move(waiting_.front());
  waiting_.pop_front();
  ++dropped_;
  SceneSnapshot& next = *waiting_.front();
  if (oldest->topologies && next.revisions.empty()) next.revisions.swap(oldest->revisions);
  next.topologies |= oldest->topologies;
  putAside(std::move(oldest));
}

/// For buffer(), without the meshes, which nobody else may need any more. The lock is held.
void SnapshotQueue::putAside(std::unique_ptr<SceneSnapshot> snapshot) {
  snapshot->revisions.clear();
  unused_.push_back(std::move(snapshot));
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
  putAside(std::move(snapshot));
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
