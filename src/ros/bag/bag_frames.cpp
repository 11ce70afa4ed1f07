#include "ros/bag/bag_frames.h"

#include <ros/message_traits.h>
#include <tf2/buffer_core.h>
#include <tf2/exceptions.h>
#include <tf2_msgs/TFMessage.h>

#include <algorithm>
#include <cstddef>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>

#include "ros/bag/bag_reader.h"
#include "ros/bag/message_reader.h"
#include "ros/conversions.h"

namespace tissue_contact {
namespace {

/// A robot of 50 frames at 100 Hz sends so many in 3 minutes; tf2 keeps all of them.
constexpr std::size_t kMaxTransforms = 1000000;

geometry_msgs::TransformStamped readTransform(MessageReader& reader) {
  geometry_msgs::TransformStamped transform;
  transform.header = reader.header();
  transform.child_frame_id = reader.text();
  geometry_msgs::Vector3& p = transform.transform.translation;
  geometry_msgs::Quaternion& q = transform.transform.rotation;
  for (double* value : {&p.x, &p.y, &p.z, &q.x, &q.y, &q.z, &q.w}) *value = reader.number<double>();
  return transform;
}

/// What a bag says of frames, transform by transform.
class BagTransforms {
 public:
  explicit BagTransforms(const std::string& file) : bag_(file) {}

  /// @param topic global; a relative one of that name is the same.
  /// @param goes_on asked before every message, with when it was recorded.
  /// @param take gets every transform.
  template <typename GoesOn, typename Take>
  void read(const std::string& topic, const GoesOn& goes_on, const Take& take) {
    bag_.select([&](const BagConnection& connection) {
      return (connection.topic == topic || "/" + connection.topic == topic) &&
             connection.md5sum == ros::message_traits::md5sum<tf2_msgs::TFMessage>();
    });
    bag_.forEach([&](const BagMessage& message) {
      if (!goes_on(message.recorded)) return false;
      try {
        readMessage(message.data, take);
      } catch (const BagError& error) {
        bag_.fail(message, error);
      }
      return true;
    });
  }

  /// Transforms that were left out because of the length of a frame's name.
  std::size_t tooLong() const { return too_long_; }

 private:
  template <typename Take>
  void readMessage(std::string_view data, const Take& take) {
    constexpr std::size_t kLeastBytes = 5 * sizeof(std::uint32_t) + 7 * sizeof(double);
    MessageReader reader(data);
    for (std::size_t left = reader.count(kLeastBytes); left > 0; --left) {
      const geometry_msgs::TransformStamped transform = readTransform(reader);
      if (std::max(transform.header.frame_id.size(), transform.child_frame_id.size()) > kLongestFrameName) {
        ++too_long_;
      } else {
        take(transform);
      }
    }
  }

  BagReader bag_;
  std::size_t too_long_ = 0;
};

}  // namespace

Pose frameInBag(const std::string& frame, const std::string& world_frame, const std::string& bag_file) {
  tf2::BufferCore buffer(ros::Duration(1e6));  // a bag is not forgotten while it is read
  BagTransforms transforms(bag_file);
  std::size_t count = 0;
  const auto take = [&](const geometry_msgs::TransformStamped& transform, bool is_static) {
    if (count++ < kMaxTransforms) takeTransform(transform, is_static, buffer);
  };
  const auto has_room = [&](ros::Time /*recorded*/) { return count < kMaxTransforms; };
  transforms.read("/tf_static", has_room, [&](const auto& transform) { take(transform, true); });
  transforms.read(
      "/tf",
      [&](ros::Time recorded) { return has_room(recorded) && !buffer.canTransform(world_frame, frame, ros::Time(0)); },
      [&](const auto& transform) { take(transform, false); });
  try {
    return toPose(buffer.lookupTransform(world_frame, frame, ros::Time(0)).transform);
  } catch (const tf2::TransformException& error) {
    std::string detail = error.what();
    if (transforms.tooLong() > 0) {
      detail += "; " + std::to_string(transforms.tooLong()) + " transforms with names of frames longer than " +
                std::to_string(kLongestFrameName) + " bytes were left out";
    }
    throw std::invalid_argument("tf frame '" + frame + "' has no transform to the world frame '" + world_frame +
                                "' in " + bag_file + " (" + detail + ")");
  }
}

FrameMotion farthestInBag(const std::string& frame, const std::string& world_frame, const std::string& bag_file,
                          ros::Time until) {
  const Pose X_WF_first = frameInBag(frame, world_frame, bag_file);
  LatestFrames latest;
  FrameMotion farthest;
  BagTransforms transforms(bag_file);
  bool has_moved = false;
  const auto measure = [&] {  // between two messages: of one, all transforms belong together
    if (!std::exchange(has_moved, false)) return;
    const std::optional<Pose> now = latest.pose(frame, world_frame);
    if (!now) return;
    const FrameMotion motion(X_WF_first, *now);
    if (motion.isFartherThan(farthest)) farthest = motion;
  };
  for (const char* topic : {"/tf_static", "/tf"}) {
    transforms.read(
        topic,
        [&](ros::Time recorded) {
          measure();
          return recorded <= until;
        },
        [&](const auto& transform) { has_moved |= latest.take(transform); });
    measure();
  }
  return farthest;
}

}  // namespace tissue_contact
