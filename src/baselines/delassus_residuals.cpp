#include <algorithm>
#include <cmath>

#include "baselines/natural_map.h"
#include "solver/residual_measures.h"
#include "tissue_contact/baselines/delassus.h"
#include "tissue_contact/friction/friction_law.h"

namespace tissue_contact {
namespace {

/// Adds the friction measures of one contact that has a normal impulse. A contact slides for them when its tangential
/// velocity is more than round-off: 1e-9 of `velocity`, the size of the problem's velocities.
void addFriction(const CoulombLaw& law, bool was_sliding, const Vector3& r, const Vector3& u, double velocity,
                 DelassusResiduals& sum) {
  const Vector2 friction = r.tail<2>();
  const Vector2 sliding = u.tail<2>();
  const double speed = sliding.norm();
  const bool slides = speed > 1e-9 * velocity;
  const double outside = frictionExcess(law, r, was_sliding || slides);
  worsen(sum.cone_violation_n_s, outside);
  sum.friction_power_j += friction.dot(sliding);
  if (!(speed > 0.0)) return;
  const Vector2 expected = std::max(r[0], 0.0) * kineticFriction(law, sliding / speed);
  // A held contact has no sliding force to compare with beyond its (larger) limit; what slip it has counts in full.
  sum.dissipation_defect_j += std::abs(friction.dot(sliding) - expected.dot(sliding));
  if (outside < -1e-9 * friction.norm()) worsen(sum.static_slip_m_per_s, speed);
  if (slides && friction.norm() > 0.0 && expected.norm() > 0.0) {
    worsen(sum.kinetic_angle_rad, angleBetween(friction, expected));
  }
}

}  // namespace

DelassusResiduals computeResiduals(const DelassusProblem& problem, const VectorX& r) {
  DelassusResiduals residuals;
  const VectorX u = problem.W * r + problem.q;
  const double velocity = naturalUnits(problem).velocity;
  residuals.scaled_natural_map = scaledNaturalMap(problem, r, u);
  for (Eigen::Index c = 0; c < problem.contacts(); ++c) {
    const Vector3 r_c = r.segment<3>(3 * c);
    const Vector3 u_c = u.segment<3>(3 * c);
    worsen(residuals.penetration_m_per_s, -u_c[0]);
    worsen(residuals.adhesion_n_s, -r_c[0]);
    worsen(residuals.complementarity_j, std::abs(r_c[0] * u_c[0]));
    addFriction(problem.laws[c], problem.was_sliding[c], r_c, u_c, velocity, residuals);
  }
  return residuals;
}

}  // namespace tissue_contact
