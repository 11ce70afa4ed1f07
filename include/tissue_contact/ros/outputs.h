/// @file
/// Room `ros`: everything the node publishes about a scene. A simulator that was just advanced in, messages out.
#pragma once

#include <geometry_msgs/TransformStamped.h>
#include <geometry_msgs/WrenchStamped.h>
#include <ros/node_handle.h>
#include <ros/publisher.h>
#include <tf2_ros/transform_broadcaster.h>

#include <cstdint>
#include <memory>
#include <vector>

#include "tissue_contact/ros/conversions.h"
#include "tissue_contact/ros/message_time_rate.h"
#include "tissue_contact/ros/scene_markers.h"
#include "tissue_contact/simulation/joint_state_player.h"

namespace tissue_contact {

/// Topics, all below the node's private namespace:
///   <instrument>/wrench  every accepted joint state of that instrument; at and in the tip link
///   <tissue>/topology    once, latched, with the first joint state
///   <tissue>/mesh, contacts, status, markers   at the scene's rates of message time (0: not advertised)
///   /tf                  on request, every accepted joint state: world -> root link -> every link
/// What nobody subscribes to is not even filled in.
class Outputs {
 public:
  /// Refuses the scene before anything is advertised. @param simulator and @param player must outlive this.
  /// @throws std::invalid_argument: a name that cannot be part of a topic, tf of two links with one name, a bad private
  ///   parameter ~markers/displacement_full_scale_m or ~markers/force_arrow_m_per_n.
  Outputs(const ros::NodeHandle& private_node, const Simulator& simulator, const JointStatePlayer& player);

  /// Publishes what is due after an accepted sample. @param step_time_s wall time per implicit step of this interval.
  /// @param substeps implicit steps taken in it.
  void publish(const PlayedSample& played, int substeps, double step_time_s);

 private:
  void advertise();
  void publishTopologies(std::int64_t stamp_ns);
  void publishWrenches(const PlayedSample& played);
  void publishMeshes(std::int64_t stamp_ns);
  void publishContacts(std::int64_t stamp_ns);
  void publishStatus(std::int64_t stamp_ns, int substeps, double step_time_s);
  void publishMarkers(std::int64_t stamp_ns);
  void publishTransforms(std::int64_t stamp_ns);
  void showToNewcomer();

  ros::NodeHandle node_;
  const Simulator& simulator_;
  const JointStatePlayer& player_;
  SceneMarkers scene_markers_;
  std::int64_t last_stamp_ns_ = 0;

  std::vector<ros::Publisher> wrench_publishers_;    ///< one per instrument
  std::vector<ros::Publisher> topology_publishers_;  ///< one per tissue
  std::vector<ros::Publisher> mesh_publishers_;      ///< one per tissue
  ros::Publisher contacts_publisher_;
  ros::Publisher status_publisher_;
  ros::Publisher markers_publisher_;
  std::unique_ptr<tf2_ros::TransformBroadcaster> broadcaster_;  ///< null: not asked for

  bool topologies_published_ = false;
  MessageTimeRate mesh_rate_;
  MessageTimeRate contacts_rate_;
  MessageTimeRate status_rate_;
  MessageTimeRate markers_rate_;

  std::vector<geometry_msgs::WrenchStamped> wrenches_;
  std::vector<TissueMesh> meshes_;
  ContactArray contacts_;
  Status status_;
  std::vector<geometry_msgs::TransformStamped> transforms_;
};

}  // namespace tissue_contact
