/// @file
/// Room `solver`, private: how wrong a contact's impulse is, for the residuals of a step and of a Delassus problem, and what counts as
/// moving.
#pragma once

#include <algorithm>
#include <cmath>

#include "tissue_contact/friction/friction_law.h"

namespace tissue_contact {

/// What moves no faster moves by round-off, m/s.
constexpr double kStillSpeed = 1e-9;

/// std::max would drop a NaN: a worst value that is not a number must stay visible.
inline void worsen(double& worst, double value) {
  if (!(value <= worst)) worst = value;
}

/// How far the tangential part of r is outside its limit, in the unit of r; negative inside.
inline double frictionExcess(const CoulombLaw& law, const Vector3& r, bool kinetic) {
  const Vector2 friction = r.tail<2>();
  if (law.anisotropic == nullptr) return friction.norm() - (kinetic ? law.mu_kinetic : law.mu_static) * r[0];
  if (!(r[0] > 0.0) || friction.isZero(0.0)) return friction.norm() - std::max(r[0], 0.0);
  return friction.norm() * (1.0 - r[0] / frictionUse(law, friction, kinetic));
}

/// 0 to pi, rad.
inline double angleBetween(const Vector2& a, const Vector2& b) {
  return std::abs(std::atan2(a.x() * b.y() - a.y() * b.x(), a.dot(b)));
}

}  // namespace tissue_contact
