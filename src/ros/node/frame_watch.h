/// @file
/// Room `ros`, private: whether the frames that a scene was placed in move while the node runs.
#pragma once

#include <diagnostic_updater/diagnostic_updater.h>
#include <tf2_ros/buffer.h>
#include <tf2_ros/transform_listener.h>

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

/// Listens to tf as long as it exists; for scenes that name frames.
class FrameWatch {
 public:
  FrameWatch(std::vector<PlacedFrame> frames, std::string world_frame);

  /// Where the frames are by now: a warning in the diagnostics for those that have moved, and once in the log. One that tf no longer
  /// knows is taken to be where it was.
  void fill(diagnostic_updater::DiagnosticStatusWrapper& status);

 private:
  struct Watched {
    PlacedFrame placed;
    FrameMotion motion;
    bool told = false;
  };

  std::string world_frame_;
  std::vector<Watched> frames_;
  tf2_ros::Buffer buffer_;
  tf2_ros::TransformListener listener_;
};

}  // namespace tissue_contact
