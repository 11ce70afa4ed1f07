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

}  // namespace tissue_contact
