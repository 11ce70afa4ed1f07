#include "ros/frame_motion.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <iomanip>
#include <sstream>
#include <stdexcept>

#include "ros/conversions.h"

namespace tissue_contact {
namespace {

constexpr std::size_t kMostFrames = 10000;
constexpr int kDeepest = 100;

bool hasLongName(const geometry_msgs::TransformStamped& transform) {
  return std::max(transform.header.frame_id.size(), transform.child_frame_id.size()) > kLongestFrameName;
}

/// As tf2 has names: without a slash in front.
std::string bareName(const std::string& name) { return name.rfind('/', 0) == 0 ? name.substr(1) : name; }

constexpr double kCounts_m = 5e-4;  // a step's way that turns a force by a per cent or more
constexpr double kArm_m = 0.5;      // from the base of an arm to its tool

}  // namespace

void takeTransform(const geometry_msgs::TransformStamped& transform, bool is_static, tf2::BufferCore& buffer) {
  if (hasLongName(transform)) return;
  try {
    buffer.setTransform(transform, "", is_static);
  } catch (const std::runtime_error&) {  // of ros::Time
  }
}

std::vector<std::string> framesOf(const Scene& scene) {
  std::vector<std::string> frames;
  const auto add = [&frames](const PoseDescription& pose) {
    const bool is_new = std::find(frames.begin(), frames.end(), pose.tf_frame) == frames.end();
    if (!pose.tf_frame.empty() && is_new) frames.push_back(pose.tf_frame);
  };
  for (const InstrumentDescription& instrument : scene.instruments) add(instrument.base_pose);
  for (const TissueDescription& tissue : scene.tissues) add(tissue.pose);
  return frames;
}

FrameMotion::FrameMotion(const Pose& X_WF_start, const Pose& X_WF_now)
    : way_m((X_WF_now.translation() - X_WF_start.translation()).norm()),
      turn_rad(Eigen::AngleAxisd(X_WF_start.linear().transpose() * X_WF_now.linear()).angle()) {}

double FrameMotion::reach() const { return std::max(way_m, kArm_m * turn_rad); }

bool FrameMotion::counts() const { return reach() > kCounts_m; }

bool LatestFrames::take(const geometry_msgs::TransformStamped& transform) {
  const std::string& parent = transform.header.frame_id;
  const std::string& child = transform.child_frame_id;
  if (parent.empty() || child.empty() || hasLongName(transform)) return false;
  Latest now{bareName(parent), Pose::Identity()};
  try {
    now.X = toPose(transform.transform);
  } catch (const std::invalid_argument&) {
    return false;
  }
  const auto at = latest_.find(bareName(child));
  if (at == latest_.end()) {
    return latest_.size() < kMostFrames && latest_.emplace(bareName(child), std::move(now)).second;
  }
  if (at->second.parent == now.parent && at->second.X.matrix() == now.X.matrix()) return false;
  at->second = std::move(now);
  return true;
}

std::optional<Pose> LatestFrames::pose(const std::string& frame, const std::string& in) const {
  const auto [root, X_RF] = inRoot(bareName(frame));
  const auto [other_root, X_RO] = inRoot(bareName(in));
  if (root != other_root) return std::nullopt;
  return X_RO.inverse() * X_RF;
}

std::pair<std::string, Pose> LatestFrames::inRoot(const std::string& frame) const {
  std::pair<std::string, Pose> found(frame, Pose::Identity());
  for (int depth = 0; depth < kDeepest; ++depth) {  // frames may go round
    const auto at = latest_.find(found.first);
    if (at == latest_.end()) break;
    found = {at->second.parent, at->second.X * found.second};
  }
  return found;
}

std::string frameMotionText(const std::string& frame, const FrameMotion& motion) {
  constexpr double kMillimetres = 1e3;
  constexpr double kDegrees = 180.0 / M_PI;
  std::ostringstream text;
  text << std::setprecision(3) << "tf frame '" << frame << "' has moved by " << kMillimetres * motion.way_m
       << " mm and turned by " << kDegrees * motion.turn_rad
       << " degrees since the scene was placed in it; what stands in it stays where it was then, so contacts are at "
          "wrong places. Start again to place it anew; a base that moves during contact wants joints of its URDF for "
          "that";
  return text.str();
}

}  // namespace tissue_contact
