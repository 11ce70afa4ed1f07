#include "tissue_contact/friction/coulomb.h"

#include <Eigen/LU>

#include "friction/sliding_search.h"
#include "tissue_contact/friction/friction_law.h"

namespace tissue_contact {
namespace {

struct Circle {
  double mu;
  FrictionPoint at(const Vector2& d) const { return {-mu * d, -mu * quarterTurn(d)}; }
  static Vector2 weight(const Vector2&, const Vector2&) { return Vector2::Ones(); }
};

}  // namespace

ContactAnswer solveCoulombContact(const Matrix3& W, const Vector3& q, const CoulombLaw& law, bool was_sliding) {
  ContactAnswer answer;
  if (!(q[0] < 0.0)) return answer;  // separating without any impulse
  if (law.anisotropic != nullptr) return solveAnisotropicContact(W, q, law, was_sliding);
  if (law.mu_static == 0.0) {
    answer.state = ContactState::kKinetic;
    answer.impulse[0] = -q[0] / W(0, 0);
    return answer;
  }
  const Vector3 sticking = -(W.inverse() * q);
  const double mu_stick = was_sliding ? law.mu_kinetic : law.mu_static;
  if (sticking[0] > 0.0 && sticking.tail<2>().norm() <= mu_stick * sticking[0]) {
    answer.state = ContactState::kStatic;
    answer.impulse = sticking;
    return answer;
  }
  answer.state = ContactState::kKinetic;
  answer.impulse = SlidingSearch<Circle>(W, q, {law.mu_kinetic}).impulse();
  return answer;
}

bool holdsMoreAtRest(const CoulombLaw& law) { return law.anisotropic != nullptr || law.mu_static > law.mu_kinetic; }

ContactAnswer holdContact(const Matrix3& W, const Vector3& q, const CoulombLaw& law) {
  ContactAnswer answer;
  if (!(q[0] < 0.0)) return answer;
  const Vector3 sticking = -(W.inverse() * q);
  // What is torn off, or shut by friction alone, is left to the law of what slides.
  if (!(sticking[0] > 0.0)) return solveCoulombContact(W, q, law, false);
  const double use = frictionUse(law, sticking.tail<2>(), false);
  if (use <= sticking[0]) return {sticking, ContactState::kStatic};
  const Vector3 per_normal(1.0, sticking[1] / use, sticking[2] / use);
  const double opens = W.row(0).dot(per_normal);
  if (!(opens > 0.0)) return solveCoulombContact(W, q, law, false);
  return {per_normal * (-q[0] / opens), ContactState::kKinetic};
}

}  // namespace tissue_contact
