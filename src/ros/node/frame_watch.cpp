#include "ros/node/frame_watch.h"

#include <ros/console.h>

#include <optional>
#include <utility>

namespace tissue_contact {

FrameWatch::FrameWatch(ros::NodeHandle node, std::vector<PlacedFrame> frames, std::string world_frame)
    : world_frame_(std::move(world_frame)) {
  for (PlacedFrame& frame : frames) frames_.push_back({std::move(frame), {}, false});
  constexpr int kQueue = 100;
  subscribers_ = {node.subscribe("/tf_static", kQueue, &FrameWatch::take, this),
                  node.subscribe("/tf", kQueue, &FrameWatch::take, this)};
}

void FrameWatch::take(const tf2_msgs::TFMessage& message) {
  const std::lock_guard<std::mutex> lock(mutex_);
  for (const geometry_msgs::TransformStamped& transform : message.transforms) latest_.take(transform);
}

void FrameWatch::fill(diagnostic_updater::DiagnosticStatusWrapper& status) {
  status.summary(diagnostic_msgs::DiagnosticStatus::OK, "where they were when the scene was placed, as far as known");
  for (Watched& frame : frames_) {
    const std::string& name = frame.placed.name;
    std::unique_lock<std::mutex> lock(mutex_);
    const std::optional<Pose> now = latest_.pose(name, world_frame_);
    lock.unlock();
    if (now) frame.motion = FrameMotion(frame.placed.X_WF, *now);
    status.add(name + ": known to tf now", now.has_value());
    status.add(name + ": moved by_m", frame.motion.way_m);
    status.add(name + ": turned by_rad", frame.motion.turn_rad);
    if (!frame.motion.counts()) continue;
    const std::string text = frameMotionText(name, frame.motion);
    status.mergeSummary(diagnostic_msgs::DiagnosticStatus::WARN, text);
    if (!std::exchange(frame.told, true)) ROS_WARN_STREAM(text << "; from now on /diagnostics has how far");
  }
}

}  // namespace tissue_contact
