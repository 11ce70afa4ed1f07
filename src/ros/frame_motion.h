/// @file
/// Room `ros`, private: frames of tf that a scene is placed in, and whether they move after that.
#pragma once

#include <string>
#include <vector>

#include "tissue_contact/core/types.h"
#include "tissue_contact/simulation/scene.h"

namespace tissue_contact {

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

/// For people: where the frame is and what that means. Begins with its name.
std::string frameMotionText(const std::string& frame, const FrameMotion& motion);

}  // namespace tissue_contact
