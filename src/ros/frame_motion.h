/// @file
/// Room `ros`, private: frames of tf that a scene is placed in, and whether they move after that.
#pragma once

#include <geometry_msgs/TransformStamped.h>
#include <tf2/buffer_core.h>

#include <cstddef>
#include <map>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "tissue_contact/core/types.h"
#include "tissue_contact/simulation/scene.h"

namespace tissue_contact {

/// Bytes. tf2 keeps the names of all frames it has heard of.
constexpr std::size_t kLongestFrameName = 256;

/// Leaves out what tf2 refuses (NaN, a frame that is its own parent) or its arithmetic of stamps throws at, and longer names.
void takeTransform(const geometry_msgs::TransformStamped& transform, bool is_static, tf2::BufferCore& buffer);

/// Frames that `base_pose` of instruments and `pose` of tissues name, each once.
std::vector<std::string> framesOf(const Scene& scene);

/// How far a frame is from where it was when the scene was placed in it.
struct FrameMotion {
  double way_m = 0.0;
  double turn_rad = 0.0;

  FrameMotion() = default;
  FrameMotion(const Pose& X_WF_start, const Pose& X_WF_now);

  /// By more than half a millimetre, at the frame or half a metre from it.
  bool counts() const;
  bool isFartherThan(const FrameMotion& other) const { return reach() > other.reach(); }

 private:
  double reach() const;
};

/// Where frames are now, by the transforms that came last, whatever their stamps. tf2 keeps ten seconds of all frames for ever, and its listener
/// ends the process on stamps that its arithmetic does not bear; neither is for a node's whole life.
class LatestFrames {
 public:
  /// What is no pose, has a name longer than 256 bytes or would be one of more than 10 000 frames is left out.
  /// @return whether a frame is elsewhere by it.
  bool take(const geometry_msgs::TransformStamped& transform);

  /// Pose of one in the other; none while they do not hang together, within 100 transforms.
  std::optional<Pose> pose(const std::string& frame, const std::string& in) const;

 private:
  struct Latest {
    std::string parent;
    Pose X;
  };

  std::pair<std::string, Pose> inRoot(const std::string& frame) const;

  std::map<std::string, Latest> latest_;
};

/// For people: where the frame is and what that means. Begins with its name.
std::string frameMotionText(const std::string& frame, const FrameMotion& motion);

}  // namespace tissue_contact
