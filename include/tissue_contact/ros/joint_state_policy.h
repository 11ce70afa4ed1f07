/// @file
/// Room `ros`: which joint states the simulation stops at when the scene leaves that open. No ROS and no clock inside.
#pragma once

#include <string>

#include "tissue_contact/scene/scene.h"

namespace tissue_contact {

struct PolicyChoice {
  StatePolicy policy = StatePolicy::kEveryState;  ///< never kAuto
  std::string reason;                             ///< for the log
};

/// @param wanted by the scene. @param simulated_time whether ROS time comes from /clock.
/// @param age_s of the first joint state that was taken: wall clock minus stamp, when it was received.
PolicyChoice choosePolicy(StatePolicy wanted, bool simulated_time, double age_s);

}  // namespace tissue_contact
