#include "ros/bag/bag_frames.h"

#include <ros/message_traits.h>
#include <tf2/buffer_core.h>
#include <tf2/exceptions.h>
#include <tf2_msgs/TFMessage.h>

#include <algorithm>
#include <cstddef>
#include <map>
#include <optional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

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
  /// @param goes_on asked before every message.
  /// @param take gets every transform.
  template <typename GoesOn, typename Take>
  void read(const std::string& topic, const GoesOn& goes_on, const Take& take) {
    bag_.select([&](const BagConnection& connection) {
      return (connection.topic == topic || "/" + connection.topic == topic) &&
             connection.md5sum == ros::message_traits::md5sum<tf2_msgs::TFMessage>();
    });
    bag_.forEach([&](const BagMessage& message) {
      if (!goes_on()) return false;
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
    const auto has_room = [&] { return count_ < kMaxTransforms; };
    transforms.read("/tf_static", has_room, [&](const auto& transform) { add(transform, true); });
    transforms.read(
        "/tf", [&] { return has_room() && !buffer_.canTransform(world_frame, frame, ros::Time(0)); },
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

  /// `frame` and all above it.
  std::vector<std::string> chainOf(const std::string& frame) const {
    std::vector<std::string> chain = {frame};
    std::string parent;
    while (buffer_._getParent(chain.back(), ros::Time(0), parent)) chain.push_back(parent);
    return chain;
  }

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

/// Where some frames are now, whatever their transforms' stamps: a recording is in the order in which these came.
class LatestFrames {
 public:
  explicit LatestFrames(const std::vector<std::string>& frames) {
    for (const std::string& frame : frames) latest_.emplace(frame, Latest());
  }

  /// @return whether it is of these frames and moves one of them. What is no pose is left out.
  bool take(const geometry_msgs::TransformStamped& transform) {
    const auto at = latest_.find(transform.child_frame_id);
    if (at == latest_.end()) return false;
    Latest& latest = at->second;
    Latest now{transform.header.frame_id, Pose::Identity()};
    try {
      now.X = toPose(transform.transform);
    } catch (const std::invalid_argument&) {
      return false;
    }
    if (latest.parent == now.parent && latest.X.matrix() == now.X.matrix()) return false;
    latest = std::move(now);
    return true;
  }

  /// Pose of one in the other; none while they do not hang together.
  std::optional<Pose> pose(const std::string& frame, const std::string& in) const {
    const auto [root, X_RF] = inRoot(frame);
    const auto [other_root, X_RO] = inRoot(in);
    if (root != other_root) return std::nullopt;
    return X_RO.inverse() * X_RF;
  }

 private:
  struct Latest {
    std::string parent;  ///< empty: not known yet
    Pose X = Pose::Identity();
  };

  std::pair<std::string, Pose> inRoot(const std::string& frame) const {
    std::pair<std::string, Pose> found(frame, Pose::Identity());
    for (std::size_t depth = 0; depth < latest_.size(); ++depth) {  // a recording may say that frames go round
      const auto at = latest_.find(found.first);
      if (at == latest_.end() || at->second.parent.empty()) break;
      found = {at->second.parent, at->second.X * found.second};
    }
    return found;
  }

  std::map<std::string, Latest> latest_;
};

}  // namespace

Pose frameInBag(const std::string& frame, const std::string& world_frame, const std::string& bag_file) {
  return FirstFrames(frame, world_frame, bag_file).pose();
}

FrameMotion farthestInBag(const std::string& frame, const std::string& world_frame, const std::string& bag_file) {
  const FirstFrames first(frame, world_frame, bag_file);
  std::vector<std::string> chain = first.chainOf(frame);
  for (std::string& above : first.chainOf(world_frame)) chain.push_back(std::move(above));
  LatestFrames latest(chain);
  FrameMotion farthest;
  BagTransforms transforms(bag_file);
  for (const char* topic : {"/tf_static", "/tf"}) {
    transforms.read(
        topic, [] { return true; },
        [&](const auto& transform) {
          if (!latest.take(transform)) return;
          const std::optional<Pose> now = latest.pose(frame, world_frame);
          if (!now) return;
          const FrameMotion motion(first.pose(), *now);
          if (motion.isFartherThan(farthest)) farthest = motion;
        });
  }
  return farthest;
}

}  // namespace tissue_contact
