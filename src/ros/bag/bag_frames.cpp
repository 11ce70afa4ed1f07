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

/// tf2 keeps the name of every frame, and a bag may have as many of them as transforms.
constexpr std::size_t kMaxFrameName = 256;

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
      if (std::max(transform.header.frame_id.size(), transform.child_frame_id.size()) > kMaxFrameName) {
        ++too_long_;
      } else {
        take(transform);
      }
    }
  }

  BagReader bag_;
  std::size_t too_long_ = 0;
};

/// As tf2 knows them from the beginning of a bag on, until it knows where `frame` is in `world_frame`.
class FirstFrames {
 public:
  /// @throws as frameInBag().
  FirstFrames(const std::string& frame, const std::string& world_frame, const std::string& bag_file)
      : buffer_(ros::Duration(1e6)) {  // a bag is not forgotten while it is read
    BagTransforms transforms(bag_file);
    const auto has_room = [&](ros::Time /*recorded*/) { return count_ < kMaxTransforms; };
    transforms.read("/tf_static", has_room, [&](const auto& transform) { add(transform, true); });
    transforms.read(
        "/tf",
        [&](ros::Time recorded) {
          return has_room(recorded) && !buffer_.canTransform(world_frame, frame, ros::Time(0));
        },
        [&](const auto& transform) { add(transform, false); });
    try {
      pose_ = toPose(buffer_.lookupTransform(world_frame, frame, ros::Time(0)).transform);
    } catch (const tf2::TransformException& error) {
      std::string detail = error.what();
      if (transforms.tooLong() > 0) {
        detail += "; " + std::to_string(transforms.tooLong()) + " transforms with names of frames longer than " +
                  std::to_string(kMaxFrameName) + " bytes were left out";
      }
      throw std::invalid_argument("tf frame '" + frame + "' has no transform to the world frame '" + world_frame +
                                  "' in " + bag_file + " (" + detail + ")");
    }
  }

  const Pose& pose() const { return pose_; }

 private:
  /// What tf2 itself refuses (NaN, a frame that is its own parent, a stamp out of range) is left out.
  void add(const geometry_msgs::TransformStamped& transform, bool is_static) {
    if (count_++ >= kMaxTransforms) return;
    try {
      buffer_.setTransform(transform, "bag", is_static);
    } catch (const std::runtime_error&) {  // arithmetic of ros::Time
    }
  }

  tf2::BufferCore buffer_;
  Pose pose_;
  std::size_t count_ = 0;
};

}  // namespace

Pose frameInBag(const std::string& frame, const std::string& world_frame, const std::string& bag_file) {
  return FirstFrames(frame, world_frame, bag_file).pose();
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
