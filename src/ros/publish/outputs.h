/// @file
/// Room `ros`, private: everything the node publishes about a scene. A simulator that was just advanced in, messages out.
#pragma once

#include <geometry_msgs/WrenchStamped.h>
#include <ros/node_handle.h>
#include <ros/publisher.h>
#include <tf2_msgs/TFMessage.h>
#include <tf2_ros/transform_broadcaster.h>

#include <cstdint>
#include <functional>
#include <memory>
#include <vector>

#include "ros/conversions.h"
#include "ros/publish/instrument_messages.h"
#include "ros/publish/publish_options.h"
#include "ros/publish/snapshot_publisher.h"
#include "ros/publish/snapshot_taker.h"
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
  /// @throws std::invalid_argument: a name that cannot be part of a topic, two links of one frame, a bad private
  ///   parameter ~publish_mesh or below ~markers.
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

  /// From now on publishes at these rates. What was advertised stays so, and nothing else is.
  void setRates(const PublishOptions& rates);

  /// Shows the scene as it is to who has subscribed to the markers since.
  void showToNewcomer();

  /// Shows, to whoever has subscribed to the markers, the scene after a reset or with another state; rates begin anew.
  void showReset();

  std::int64_t snapshotsDropped() { return bulky_.queue().dropped(); }

 private:
  void showMarkers();
  void publishSnapshot(const PlayedSample& played, int substeps, double step_time_s);

  ros::NodeHandle node_;
  const Simulator& simulator_;
  const PublishOptions options_;
  const std::function<void(Status&)> complete_;
  SnapshotPublisher bulky_;
  SnapshotTaker taker_;
  std::int64_t last_stamp_ns_ = 0;

  std::vector<ros::Publisher> wrench_publishers_;               ///< one per instrument
  std::vector<ros::Publisher> body_publishers_;                 ///< one per instrument; empty: not asked for
  std::vector<ros::Publisher> spatial_publishers_;              ///< likewise
  std::unique_ptr<tf2_ros::TransformBroadcaster> broadcaster_;  ///< null: not asked for

  const FrameNames frames_;
  std::vector<geometry_msgs::WrenchStamped> wrenches_;
  CrtkMessages crtk_;
  tf2_msgs::TFMessage transforms_;
};

}  // namespace tissue_contact
