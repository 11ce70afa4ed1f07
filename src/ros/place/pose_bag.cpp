#include "ros/place/pose_bag.h"

#include <geometry_msgs/PoseStamped.h>
#include <geometry_msgs/TransformStamped.h>
#include <ros/message_traits.h>

#include <algorithm>
#include <cstddef>
#include <set>
#include <stdexcept>

#include "ros/bag/bag_reader.h"
#include "ros/bag/joint_state_bag.h"
#include "ros/bag/message_reader.h"
#include "ros/conversions.h"
#include "tissue_contact/core/text.h"

namespace tissue_contact {
namespace {

constexpr std::size_t kMostPoses = 1000000;  // three hours at 100 Hz

bool isTransform(const BagConnection& connection) {
  return connection.md5sum == ros::message_traits::md5sum<geometry_msgs::TransformStamped>();
}

bool isPose(const BagConnection& connection) {
  return isTransform(connection) || connection.md5sum == ros::message_traits::md5sum<geometry_msgs::PoseStamped>();
}

/// Both types have the same numbers in the same order.
void addPose(const BagMessage& message, MeasuredPoses& measured) {
  MessageReader reader(message.data);
  const std_msgs::Header header = reader.header();
  if (isTransform(message.connection)) reader.text();  // of the child
  geometry_msgs::Transform transform;
  geometry_msgs::Vector3& p = transform.translation;
  geometry_msgs::Quaternion& q = transform.rotation;
  for (double* value : {&p.x, &p.y, &p.z, &q.x, &q.y, &q.z, &q.w}) *value = reader.number<double>();
  if (measured.poses.empty()) measured.frame = header.frame_id;
  if (header.frame_id != measured.frame) {
    throw BagError("a pose in the frame " + inQuotes(header.frame_id) + " after those in " + inQuotes(measured.frame) +
                       ": record poses of one frame",
                   BagError::Remedy::kAsSaid);
  }
  try {
    measured.poses.push_back({static_cast<std::int64_t>(header.stamp.toNSec()), toPose(transform)});
  } catch (const std::invalid_argument&) {  // a pose that is none
    ++measured.unusable;
  }
}

}  // namespace

MeasuredPoses readPoses(const std::string& bag_file, const std::string& topic) {
  BagReader bag(bag_file);
  const auto isTopic = [&](const BagConnection& one) { return globalName(one.topic) == globalName(topic); };
  std::set<std::string> known;
  for (const auto& [number, connection] : bag.connections()) {
    if (isPose(connection)) known.insert(connection.topic);
  }
  bag.select([&](const BagConnection& connection) { return isTopic(connection) && isPose(connection); });
  MeasuredPoses measured;
  bag.forEach([&](const BagMessage& message) {
    if (measured.poses.size() == kMostPoses) bag.fail("it has more than a million poses on " + topic);
    try {
      addPose(message, measured);
    } catch (const BagError& error) {
      bag.fail(message, error);
    }
    return true;
  });
  if (measured.poses.empty() && measured.unusable > 0) {
    bag.fail("all " + std::to_string(measured.unusable) + " poses on '" + topic +
             "' are none: a number is not finite, or the quaternion is zero; have its publisher fill it (0, 0, 0, 1: "
             "no rotation)");
  }
  if (measured.poses.empty()) {
    bag.fail("it has no pose on '" + topic +
             "'; topics with poses (PoseStamped, TransformStamped): " + joinedNames(known));
  }
  std::stable_sort(measured.poses.begin(), measured.poses.end(),
                   [](const StampedPose& a, const StampedPose& b) { return a.stamp_ns < b.stamp_ns; });
  return measured;
}

}  // namespace tissue_contact
