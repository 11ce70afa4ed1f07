#include "ros/frame_motion.h"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <iomanip>
#include <sstream>

namespace tissue_contact {
namespace {

constexpr double kCounts_m = 5e-4;  // a step's way that turns a force by a per cent or more
constexpr double kArm_m = 0.5;      // from the base of an arm to its tool

}  // namespace

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
