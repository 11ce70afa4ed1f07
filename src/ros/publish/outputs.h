/// @file
/// Room `ros`, private: everything the node publishes about a scene. A simulator that was just advanced in, messages out.
#pragma once

#include <geometry_msgs/TransformStamped.h>
#include <geometry_msgs/WrenchStamped.h>
#include <ros/node_handle.h>
#include <ros/publisher.h>
#include <tf2_ros/transform_broadcaster.h>

#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "ros/conversions.h"
#include "ros/publish/message_time_rate.h"
#include "ros/publish/publish_options.h"
#include "ros/publish/snapshot_publisher.h"
#include "tissue_contact/simulation/joint_state_player.h"

namespace tissue_contact {

/// Topics, all below the node's private namespace:
///   <instrument>/wrench  one for every arm state the simulator was stepped to; at and in the tip link
///   <instrument>/body/measured_cf, <instrument>/spatial/measured_cf   on request, with each wrench, see crtk_wrench.h
///   <tissue>/topology    latched, with the first joint state and after changes of the mesh, no more often than meshes
///   <tissue>/mesh, contacts, status, markers   at the scene's rates of message time (0: not advertised)
///   /tf                  on request, every moment stepped to: world -> root link -> every link
/// What nobody subscribes to is not even filled in. The stepping thread calls all but start(); wrenches and /tf
/// leave from it, the others from the thread of SnapshotPublisher.
class Outputs {
 public:
  /// Refuses the scene before anything is advertised. Simulator and player must outlive this.
  /// @param complete fills in what only its caller knows of a Status.
  /// @throws std::invalid_argument: a name that cannot be part of a topic, tf of two links with one name, a bad private
  ///   parameter ~publish_mesh, ~markers/displacement_full_scale_m or ~markers/force_arrow_m_per_n.
  Outputs(const ros::NodeHandle& private_node, const Simulator& simulator, const JointStatePlayer& player,
          const PublishOptions& options, std::function<void(Status&)> complete);

  /// Advertises.
  /// @param on_newcomer called from another thread when showToNewcomer() should be.
  void start(std::function<void()> on_newcomer);

  /// The wrenches an accepted moment owes.
  void publishWrenches(const PlayedSample& played);

  /// All else that is due after it.
  /// @param step_time_s wall time per implicit step of this interval.
  /// @param substeps implicit steps taken in it.
  void publishState(const PlayedSample& played, int substeps, double step_time_s);

  /// Shows the scene as it is to who has subscribed to the markers since.
  void showToNewcomer();

  std::int64_t snapshotsDropped() { return bulky_.queue().dropped(); }

 private:
  void publishCrtk(int instrument, std::int64_t stamp_ns);
  void publishSnapshot(std::int64_t stamp_ns, int substeps, double step_time_s);
  bool topologiesChange();
  void publishTransforms(std::int64_t stamp_ns);

  ros::NodeHandle node_;
  const Simulator& simulator_;
  const JointStatePlayer& player_;
  const PublishOptions options_;
  const std::function<void(Status&)> complete_;
  SnapshotPublisher bulky_;
  std::vector<ShownMesh> meshes_;    ///< one per tissue
  std::vector<int> told_revisions_;  ///< of the last topology of each tissue put into a snapshot; -1: none
  std::int64_t last_stamp_ns_ = 0;

  std::vector<ros::Publisher> wrench_publishers_;               ///< one per instrument
  std::vector<ros::Publisher> body_publishers_;                 ///< one per instrument; empty: not asked for
  std::vector<ros::Publisher> spatial_publishers_;              ///< likewise
  std::unique_ptr<tf2_ros::TransformBroadcaster> broadcaster_;  ///< null: not asked for

  MessageTimeRate mesh_rate_;
  MessageTimeRate contacts_rate_;
  MessageTimeRate status_rate_;
  MessageTimeRate markers_rate_;

  std::vector<geometry_msgs::WrenchStamped> wrenches_;
  geometry_msgs::WrenchStamped crtk_;
  std::vector<geometry_msgs::TransformStamped> transforms_;
};

}  // namespace tissue_contact
