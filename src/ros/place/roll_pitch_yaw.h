/// @file
/// Room `ros/place`, private: a rotation as people write it in a scene.
#pragma once

#include <cmath>

#include "tissue_contact/core/types.h"

namespace tissue_contact {

/// R = Rz(yaw) Ry(pitch) Rx(roll), as rpy_rad of a scene. Pitched by 90 degrees only the sum or the difference of the others counts, and both
/// would be angles between numbers of round-off: yaw is 0 then.
inline Vector3 rollPitchYaw(const Matrix3& R) {
  constexpr double kUpright = 1e-8;
  const double level = std::hypot(R(2, 1), R(2, 2));
  const double pitch = std::atan2(-R(2, 0), level);
  if (level < kUpright) return {std::atan2(-R(1, 2), R(1, 1)), pitch, 0.0};
  return {std::atan2(R(2, 1), R(2, 2)), pitch, std::atan2(R(1, 0), R(0, 0))};
}

}  // namespace tissue_contact
