#include "ros/bag/bag_frames.h"

#include <ros/message_traits.h>
#include <tf2/buffer_core.h>
#include <tf2/exceptions.h>
#include <tf2_msgs/TFMessage.h>

#include <algorithm>
#include <cstddef>
#include <stdexcept>
#include <string>

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

/// Adds what a bag holds to a buffer, transform by transform.
class BagTransforms {
 public:
  explicit BagTransforms(const std::string& file) : bag_(file) {}

  /// @param topic global; a relative one of that name is the same.
  /// @param enough whether to stop, asked before every message.
  template <typename Enough>
  void read(const std::string& topic, bool is_static, tf2::BufferCore& buffer, const Enough& enough) {
    bag_.select([&](const BagConnection& connection) {
      return (connection.topic == topic || "/" + connection.topic == topic) &&
             connection.md5sum == ros::message_traits::md5sum<tf2_msgs::TFMessage>();
    });
    bag_.forEach([&](const BagMessage& message) {
      if (enough()) return false;
      try {
        add(message.data, is_static, buffer);
      } catch (const BagError& error) {
        bag_.fail(message, error);
      }
      return count_ < kMaxTransforms;
    });
  }

  /// Transforms that were left out because of the length of a frame's name.
  std::size_t tooLong() const { return too_long_; }

 private:
  /// What tf2 itself refuses (NaN, a frame that is its own parent, a stamp out of range) is left out.
  void add(std::string_view data, bool is_static, tf2::BufferCore& buffer) {
    constexpr std::size_t kLeastBytes = 5 * sizeof(std::uint32_t) + 7 * sizeof(double);
    MessageReader reader(data);
    for (std::size_t left = reader.count(kLeastBytes); left > 0 && count_ < kMaxTransforms; --left, ++count_) {
      const geometry_msgs::TransformStamped transform = readTransform(reader);
      if (std::max(transform.header.frame_id.size(), transform.child_frame_id.size()) > kMaxFrameName) {
        ++too_long_;
        continue;
      }
      try {
        buffer.setTransform(transform, "bag", is_static);
      } catch (const std::runtime_error&) {  // arithmetic of ros::Time
      }
    }
  }

  BagReader bag_;
  std::size_t count_ = 0;
  std::size_t too_long_ = 0;
};

}  // namespace

Pose frameInBag(const std::string& frame, const std::string& world_frame, const std::string& bag_file) {
  tf2::BufferCore buffer(ros::Duration(1e6));  // a bag is not forgotten while it is read
  BagTransforms transforms(bag_file);
  transforms.read("/tf_static", true, buffer, [] { return false; });
  transforms.read("/tf", false, buffer, [&] { return buffer.canTransform(world_frame, frame, ros::Time(0)); });
  try {
    return toPose(buffer.lookupTransform(world_frame, frame, ros::Time(0)).transform);
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

}  // namespace tissue_contact
