/// @file
/// Room `ros`, private: whether the frames that a scene was placed in move while the node runs.
#pragma once

#include <diagnostic_updater/diagnostic_updater.h>
#include <ros/node_handle.h>
#include <ros/subscriber.h>
#include <tf2_msgs/TFMessage.h>

#include <array>
#include <mutex>
#include <string>
#include <vector>

#include "ros/frame_motion.h"
#include "tissue_contact/core/types.h"

namespace tissue_contact {

/// A frame as it was when the scene was placed in it.
struct PlacedFrame {
  std::string name;
  Pose X_WF;
};

/// Listens to tf as long as it exists; for scenes that name frames. Its callbacks are roscpp's; fill() may be another thread's.
class FrameWatch {
 public:
  FrameWatch(ros::NodeHandle node, std::vector<PlacedFrame> frames, std::string world_frame);

  /// Where the frames are by now: a warning in the diagnostics for those that have moved, and once in the log. Of one that tf does not
  /// know now, where it was last.
  void fill(diagnostic_updater::DiagnosticStatusWrapper& status);

 private:
  struct Watched {
    PlacedFrame placed;
    FrameMotion motion;
    bool told = false;
  };

  void take(const tf2_msgs::TFMessage& message);

  std::string world_frame_;
  std::vector<Watched> frames_;  ///< fill()'s alone
  std::mutex mutex_;
  LatestFrames latest_;  ///< guarded by mutex_
  std::array<ros::Subscriber, 2> subscribers_;
};

}  // namespace tissue_contact
