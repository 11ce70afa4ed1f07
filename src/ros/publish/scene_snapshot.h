/// @file
/// Room `ros`, private: what the bulky topics show of a simulator at one instant, so that messages can be made while it goes on.
#pragma once

#include <condition_variable>
#include <cstddef>
#include <cstdint>
#include <deque>
#include <memory>
#include <mutex>
#include <vector>

#include "ros/publish/mesh_revision.h"
#include "tissue_contact/Status.h"
#include "tissue_contact/simulation/simulator.h"

namespace tissue_contact {

/// Reused from one instant to the next: nothing is allocated once its vectors have grown.
struct SceneSnapshot {
  std::int64_t stamp_ns = 0;
  long step = 0;
  /// Per tissue: the mesh whose nodes the positions are. Only with `topologies`, `mesh` or `markers`.
  std::vector<std::shared_ptr<const MeshRevision>> revisions;
  std::vector<NodalVectors> positions;        ///< per tissue, m, world frame
  std::vector<std::vector<Pose>> link_poses;  ///< per instrument: X_WL of every link
  std::vector<SolvedContact> contacts;        ///< their p_WC: touchedPoint()
  Status status;

  /// What is to be published of it; the rest need not be filled in.
  bool topologies = false;  ///< where they have changed
  bool mesh = false;
  bool contact_array = false;
  bool markers = false;
  bool with_status = false;
};

/// Copies what the snapshot wants, all but the status.
/// @param meshes one for each tissue.
void takeSnapshot(const Simulator& simulator, std::vector<ShownMesh>& meshes, std::int64_t stamp_ns,
                  SceneSnapshot& snapshot);

/// What to take snapshots with of a simulator that has not been advanced.
std::vector<ShownMesh> shownMeshes(const Simulator& simulator, PublishedMesh which);

/// Snapshots between the stepping thread and the publishing one: bounded, buffers reused; the stepping thread never
/// waits. When the publishing thread does not keep up the oldest is dropped and counted; topologies it was to show, the next one shows.
/// Thread-safe.
class SnapshotQueue {
 public:
  /// @param most snapshots that wait at most, > 0.
  explicit SnapshotQueue(std::size_t most) : most_(most) {}

  /// An unused buffer to fill in, for put().
  std::unique_ptr<SceneSnapshot> buffer();
  void put(std::unique_ptr<SceneSnapshot> snapshot);

  /// Waits for a snapshot; null once closed. Give it back with recycle().
  std::unique_ptr<SceneSnapshot> take();
  void recycle(std::unique_ptr<SceneSnapshot> snapshot);

  /// Nothing more is given out.
  void close();

  std::int64_t dropped() const;

 private:
  void drop();
  void putAside(std::unique_ptr<SceneSnapshot> snapshot);

  const std::size_t most_;
  mutable std::mutex mutex_;  ///< guards all below
  std::condition_variable changed_;
  std::deque<std::unique_ptr<SceneSnapshot>> waiting_;
  std::vector<std::unique_ptr<SceneSnapshot>> unused_;
  bool closed_ = false;
  std::int64_t dropped_ = 0;
};

}  // namespace tissue_contact
