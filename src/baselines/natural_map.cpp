#include "baselines/natural_map.h"

#include <algorithm>
#include <cmath>

namespace tissue_contact {
namespace {

/// |F| of one contact, whatever its law: with the isotropic coefficient that fits best (held by static friction, where
/// the contact may be and does not slide; kinetic otherwise); for an anisotropic law the change of r' by solving the
/// contact exactly.
/// @param W_cc 3x3 block of the contact, 1/kg.
double contactDefect(const Matrix3& W_cc, const Vector3& r, const Vector3& u, const CoulombLaw& law, bool was_sliding,
                     const NaturalUnits& units) {
  if (law.anisotropic != nullptr) {
    if (!(W_cc(0, 0) > 0.0)) return r.norm() / units.impulse;
    return (r - solveCoulombContact(W_cc, u - W_cc * r, law, was_sliding).impulse).norm() / units.impulse;
  }
  const Vector3 r_scaled = r / units.impulse;
  const Vector3 u_scaled = u / units.velocity;
  const double kinetic = naturalMap(r_scaled, u_scaled, law.mu_kinetic).norm();
  if (was_sliding || law.mu_static == law.mu_kinetic) return kinetic;
  const double held = std::hypot(naturalMap(r_scaled, u_scaled, law.mu_static).norm(), u_scaled.tail<2>().norm());
  return held < kinetic ? held : kinetic;  // as written, a NaN in either is not lost: both then contain it
}

}  // namespace

Vector3 projectOntoCone(const Vector3& x, double mu) {
  const double size = x.tail<2>().norm();
  if (mu * size <= -x[0]) return Vector3::Zero();
  if (size <= mu * x[0]) return x;
  const double normal = (x[0] + mu * size) / (1.0 + mu * mu);
  return {normal, mu * normal * x[1] / size, mu * normal * x[2] / size};
}

Matrix3 coneProjectionDerivative(const Vector3& x, double mu) {
  const double size = x.tail<2>().norm();
  if (mu * size <= -x[0]) return Matrix3::Zero();
  if (size <= mu * x[0]) return Matrix3::Identity();
  const double scale = 1.0 / (1.0 + mu * mu);
  const Vector2 d = x.tail<2>() / size;
  const double normal = scale * (x[0] + mu * size);
  Matrix3 derivative;
  derivative(0, 0) = scale;
  derivative.block<1, 2>(0, 1) = scale * mu * d.transpose();
  derivative.block<2, 1>(1, 0) = scale * mu * d;
  derivative.block<2, 2>(1, 1) =
      scale * mu * mu * d * d.transpose() + mu * normal / size * (Matrix2::Identity() - d * d.transpose());
  return derivative;
}

Vector3 naturalMap(const Vector3& r, const Vector3& u, double mu) {
  Vector3 x = r - u;
  x[0] -= mu * u.tail<2>().norm();
  return r - projectOntoCone(x, mu);
}

NaturalUnits naturalUnits(const DelassusProblem& problem) {
  NaturalUnits units;
  const double velocity = problem.q.norm();
  const double compliance = problem.W.trace() / static_cast<double>(std::max<Eigen::Index>(problem.q.size(), 1));
  if (velocity > 0.0) units.velocity = velocity;
  units.impulse = compliance > 0.0 ? units.velocity / compliance : 1.0;
  return units;
}

double scaledNaturalMap(const DelassusProblem& problem, const VectorX& r, const VectorX& u) {
  const NaturalUnits units = naturalUnits(problem);
  double sum = 0.0;
  for (Eigen::Index c = 0; c < problem.contacts(); ++c) {
    const double defect = contactDefect(problem.W.block<3, 3>(3 * c, 3 * c), r.segment<3>(3 * c), u.segment<3>(3 * c),
                                        problem.laws[c], problem.was_sliding[c], units);
    sum += defect * defect;
  }
  return std::sqrt(sum);
}

}  // namespace tissue_contact
