/// @file
/// Room `ros/place`, private: the base of a robot from recorded tip poses. Poses in two frames in, the pose between them out.
#pragma once

#include <cstdint>
#include <vector>

#include "tissue_contact/core/types.h"

namespace tissue_contact {

/// A tip at a moment, in some frame.
struct StampedPose {
  std::int64_t stamp_ns = 0;
  Pose X = Pose::Identity();
};

/// One tip pose by kinematics from the base (B) and as measured in the world (W).
struct PosePair {
  Pose X_BT;
  Pose X_WT;
};

/// Measured poses on the straight way between their neighbours in time, at the moments of `tips`; moments outside, or between measured
/// poses more than 0.1 s apart, are left out.
/// @param measured ascending in time.
std::vector<PosePair> pairPoses(const std::vector<StampedPose>& tips, const std::vector<StampedPose>& measured);

struct Registration {
  Pose X_WB = Pose::Identity();
  double rms_m = 0.0;      ///< distance between measured and registered tip
  double largest_m = 0.0;  ///< of these distances
  /// RMS of how far the tip goes from its mean, along the three axes in which it goes farthest, less and least.
  Vector3 spread_m = Vector3::Zero();
  double tip_turn_rad =
      0.0;  ///< mean rotation between the tip frames, by which measured ones are turned against the model's
  double turn_rms_rad = 0.0;  ///< what is left of the rotation between them
};

/// Rigid, without scale; least squares in position (Umeyama 1991); rotations of the tip have no say, and are compared afterwards.
/// @param pairs at least one.
Registration registerBase(const std::vector<PosePair>& pairs);

/// Throws what the registration is not to be trusted for.
/// @throws std::runtime_error saying what the motion lacks or what to look at.
void requireTrustworthy(const Registration& registration);

}  // namespace tissue_contact
