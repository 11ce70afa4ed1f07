/// @file
/// Room `ros`, private: when which bulky topic is due, and the snapshot it is made of. A simulator that was just advanced in; a snapshot out.
#pragma once

#include <cstdint>
#include <functional>
#include <vector>

#include "ros/publish/message_time_rate.h"
#include "ros/publish/publish_options.h"
#include "ros/publish/scene_snapshot.h"
#include "tissue_contact/simulation/joint_state_player.h"

namespace tissue_contact {

/// A choice of bulky topics. Topologies are told whether or not anybody listens, since they are latched.
struct BulkyTopics {
  bool topologies = true;
  bool mesh = true;
  bool contacts = true;
  bool status = true;
  bool markers = true;

  bool any() const { return topologies || mesh || contacts || status || markers; }
};

/// Rates are of message time. Not thread-safe.
class SnapshotTaker {
 public:
  /// @param simulator not advanced yet; it and the player must outlive this.
  SnapshotTaker(const Simulator& simulator, const JointStatePlayer& player, const PublishOptions& options,
                PublishedMesh mesh);

  /// From now on these rates; no meshes are told of that were not at the start.
  void setRates(const PublishOptions& rates);
  /// After a reset: everything is due with the next moment.
  void beginAnew();

  /// After a moment was played: what is due, each at most if it is wanted.
  BulkyTopics due(const PlayedSample& played, const BulkyTopics& wanted);

  /// Copies that.
  /// @param steps implicit steps of the interval that ended with this moment.
  /// @param complete fills in what only the caller knows of a status.
  void take(const PlayedSample& played, const BulkyTopics& due, int steps, const std::function<void(Status&)>& complete,
            SceneSnapshot& snapshot);

  /// The scene as it is, for markers alone.
  void takeMarkers(std::int64_t stamp_ns, SceneSnapshot& snapshot);

 private:
  bool topologiesChange();

  const Simulator& simulator_;
  const JointStatePlayer& player_;
  std::vector<ShownMesh> meshes_;    ///< one per tissue
  std::vector<int> told_revisions_;  ///< of the last topology of each tissue put into a snapshot; -1: none
  const bool shows_meshes_;
  PublishOptions rates_;
  MessageTimeRate mesh_rate_;
  MessageTimeRate contacts_rate_;
  MessageTimeRate status_rate_;
  MessageTimeRate markers_rate_;
};

}  // namespace tissue_contact
