/// @file
/// Room `ros`, private: between ROS messages and the core's types. Every fill function writes into a message kept by the caller,
/// so that its vectors and strings are allocated once.
#pragma once

#include <geometry_msgs/Point.h>
#include <geometry_msgs/Pose.h>
#include <geometry_msgs/Transform.h>
#include <geometry_msgs/Vector3.h>
#include <geometry_msgs/WrenchStamped.h>
#include <ros/time.h>
#include <sensor_msgs/JointState.h>

#include <cstdint>

#include "ros/publish/scene_snapshot.h"
#include "tissue_contact/ContactArray.h"
#include "tissue_contact/Status.h"
#include "tissue_contact/TissueMesh.h"
#include "tissue_contact/TissueTopology.h"
#include "tissue_contact/simulation/joint_state_player.h"
#include "tissue_contact/simulation/simulator.h"

namespace tissue_contact {

/// @param stamp_ns > 0 and taken from a ros::Time, so it fits one.
ros::Time toTime(std::int64_t stamp_ns);

geometry_msgs::Point toPoint(const Vector3& p);
geometry_msgs::Vector3 toVector(const Vector3& v);
geometry_msgs::Pose toPose(const Pose& X);
geometry_msgs::Transform toTransform(const Pose& X);

/// @throws std::invalid_argument when the quaternion is not finite or zero.
Pose toPose(const geometry_msgs::Transform& transform);

/// Names, positions, velocities and stamp; velocity may be empty, effort is not used.
JointStateSample toSample(const sensor_msgs::JointState& message);

/// Wrench of the tissues on the instrument at its tip link's origin and in its axes; header.frame_id is the caller's.
void fillWrench(const Wrench& wrench, std::int64_t stamp_ns, geometry_msgs::WrenchStamped& message);

/// Revision, rest positions, tetrahedra, surface and fixed nodes; all but header and tissue.
void fillTopology(const MeshRevision& mesh, TissueTopology& message);

/// Positions, their revision and the step of a snapshot taken with `mesh`; all but frame_id and tissue, which do not change.
void fillMesh(const SceneSnapshot& snapshot, int tissue, TissueMesh& message);

/// All contacts of a snapshot's step; all but frame_id.
/// @param simulator for the names alone; its meshes may change meanwhile.
void fillContacts(const Simulator& simulator, const SceneSnapshot& snapshot, ContactArray& message);

/// The last step's report and the player's counts; all but what only a clock or the caller's own counts can tell.
void fillStatus(const Simulator& simulator, const JointStatePlayer& player, std::int64_t stamp_ns, Status& message);

bool isFinite(const Residuals& residuals);

/// Whether every tissue position, contact and wrench is finite: what is not is never published. Residuals cost something and are
/// asked for where they are told.
bool isFinite(const Simulator& simulator);

}  // namespace tissue_contact
