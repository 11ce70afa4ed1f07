#include <algorithm>
#include <cmath>

#include "solver/natural_map.h"
#include "tissue_contact/friction/friction_law.h"
#include "tissue_contact/solver/delassus.h"

namespace tissue_contact {
namespace {

/// std::max would drop a NaN: a worst value that is not a number must stay visible.
void worsen(double& worst, double value) {
  if (!(value <= worst)) worst = value;
}

/// How far r_t is outside its limit, N s; negative inside.
double excess(const CoulombLaw& law, const Vector3& r, bool kinetic) {
  const Vector2 friction = r.tail<2>();
  if (law.anisotropic == nullptr) return friction.norm() - (kinetic ? law.mu_kinetic : law.mu_static) * r[0];
  if (!(r[0] > 0.0) || friction.isZero(0.0)) return friction.norm() - (r[0] > 0.0 ? r[0] : 0.0);
  return friction.norm() * (1.0 - r[0] / frictionUse(law, friction, kinetic));
}

/// Adds the friction measures of one contact that has a normal impulse. A contact slides for them when its tangential
/// velocity is more than round-off: 1e-9 of `velocity`, the size of the problem's velocities.
void addFriction(const CoulombLaw& law, bool was_sliding, const Vector3& r, const Vector3& u, double velocity,
                 DelassusResiduals& sum) {
  const Vector2 friction = r.tail<2>();
  const Vector2 sliding = u.tail<2>();
  const double speed = sliding.norm();
  const bool slides = speed > 1e-9 * velocity;
  const double outside = excess(law, r, was_sliding || slides);
  worsen(sum.cone_violation_n_s, outside);
  sum.friction_power_j += friction.dot(sliding);
  if (!(speed > 0.0)) return;
  const Vector2 expected = std::max(r[0], 0.0) * kineticFriction(law, sliding / speed);
  // A held contact has no sliding force to compare with beyond its (larger) limit; what slip it has counts in full.
  sum.dissipation_defect_j += std::abs(friction.dot(sliding) - expected.dot(sliding));
  if (outside < -1e-9 * friction.norm()) worsen(sum.static_slip_m_per_s, speed);
  if (slides && friction.norm() > 0.0 && expected.norm() > 0.0) {
    const double cross = friction.x() * expected.y() - friction.y() * expected.x();
    worsen(sum.kinetic_angle_rad, std::abs(std::atan2(cross, friction.dot(expected))));
  }
}

}  // namespace

DelassusResiduals computeResiduals(const DelassusProblem& problem, const VectorX& r) {
  DelassusResiduals residuals;
  const VectorX u = problem.W * r + problem.q;
  const NaturalUnits units = naturalUnits(problem);
  double map = 0.0;
  for (Eigen::Index c = 0; c < problem.contacts(); ++c) {
    const Vector3 r_c = r.segment<3>(3 * c);
    const Vector3 u_c = u.segment<3>(3 * c);
    const Matrix3 W_cc = problem.W.block<3, 3>(3 * c, 3 * c);
    const double defect = contactDefect(W_cc, r_c, u_c, problem.laws[c], problem.was_sliding[c], units);
    map += defect * defect;
    worsen(residuals.penetration_m_per_s, -u_c[0]);
    worsen(residuals.adhesion_n_s, -r_c[0]);
    worsen(residuals.complementarity_j, std::abs(r_c[0] * u_c[0]));
    addFriction(problem.laws[c], problem.was_sliding[c], r_c, u_c, units.velocity, residuals);
  }
  residuals.scaled_natural_map = std::sqrt(map);
  return residuals;
}

}  // namespace tissue_contact
