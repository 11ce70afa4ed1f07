#include "ros/node/frame_watch.h"

#include <ros/console.h>
#include <tf2/exceptions.h>

#include <stdexcept>
#include <utility>

#include "ros/conversions.h"

namespace tissue_contact {

FrameWatch::FrameWatch(std::vector<PlacedFrame> frames, std::string world_frame)
    : world_frame_(std::move(world_frame)), listener_(buffer_) {
  for (PlacedFrame& frame : frames) frames_.push_back({std::move(frame), {}, false});
}

void FrameWatch::fill(diagnostic_updater::DiagnosticStatusWrapper& status) {
  status.summary(diagnostic_msgs::DiagnosticStatus::OK, "where they were when the scene was placed");
  for (Watched& frame : frames_) {
    const std::string& name = frame.placed.name;
    try {
      const auto now = buffer_.lookupTransform(world_frame_, name, ros::Time(0));
      frame.motion = FrameMotion(frame.placed.X_WF, toPose(now.transform));
    } catch (const tf2::TransformException&) {
    } catch (const std::invalid_argument&) {  // no pose
    }
    status.add(name + ": moved by_m", frame.motion.way_m);
    status.add(name + ": turned by_rad", frame.motion.turn_rad);
    if (!frame.motion.counts()) continue;
    const std::string text = frameMotionText(name, frame.motion);
    status.mergeSummary(diagnostic_msgs::DiagnosticStatus::WARN, text);
    if (!std::exchange(frame.told, true)) ROS_WARN_STREAM(text);
  }
}

}  // namespace tissue_contact
