#include "tissue_contact/friction/coulomb.h"

#include <Eigen/LU>

namespace tissue_contact {
namespace {

/// Direction of sliding d and normal impulse r_n of a sliding contact by fixed point: r_n from d, friction from r_n, d
/// from friction. Starts from the direction in which the contact would slide if released from sticking.
ContactAnswer slide(const Matrix3& W, const Vector3& q, double mu, const Vector2& sticking_impulse) {
  constexpr int kMaxSteps = 50;       // reached only when mu |W_nt| is close to W_nn; typical contacts need 2 to 4
  constexpr double kSettled = 1e-30;  // squared change of a unit vector: round-off
  const double W_nn = W(0, 0);
  const Vector2 W_nt(W(0, 1), W(0, 2));
  const Vector2 W_tn(W(1, 0), W(2, 0));
  const Matrix2 W_tt = W.bottomRightCorner<2, 2>();
  Vector2 d = -sticking_impulse.normalized();
  double normal = 0.0;
  for (int step = 0; step < kMaxSteps; ++step) {
    // W_nn r_n - mu r_n W_nt.d + q_n = 0. The bracket can lose its sign at large mu (the contact would jam): then the
    // friction of the last round is kept on the right-hand side instead.
    const double bracket = W_nn - mu * W_nt.dot(d);
    normal = bracket > 0.1 * W_nn ? -q[0] / bracket : (-q[0] + mu * normal * W_nt.dot(d)) / W_nn;
    normal = normal > 0.0 ? normal : 0.0;
    const Vector2 friction = minimizeOnDisc(W_tt, q.tail<2>() + W_tn * normal, mu * normal);
    const double size = friction.norm();
    if (!(size > 0.0)) break;
    const Vector2 next = -friction / size;
    const double change = (next - d).squaredNorm();
    d = next;
    if (change < kSettled) break;
  }
  ContactAnswer answer;
  answer.state = ContactState::kKinetic;
  answer.impulse << normal, -mu * normal * d;
  return answer;
}

}  // namespace

Vector2 minimizeOnDisc(const Matrix2& W, const Vector2& s, double radius) {
  Vector2 x = -(W.inverse() * s);
  if (!(x.norm() > radius)) return x;
  if (!(radius > 0.0)) return Vector2::Zero();
  // Newton on 1/|x(sigma)| = 1/radius: concave, so it converges monotonically from sigma = 0 (More & Sorensen 1983).
  constexpr int kMaxSteps = 40;
  constexpr double kRoundOff = 4e-16;
  double sigma = 0.0;
  for (int step = 0; step < kMaxSteps; ++step) {
    const Matrix2 inverse = (W + sigma * Matrix2::Identity()).inverse();
    x = -(inverse * s);
    const double size = x.norm();
    const double excess = size / radius - 1.0;
    if (!(excess > kRoundOff)) break;
    sigma += excess * size * size / x.dot(inverse * x);
  }
  return x;
}

ContactAnswer solveCoulombContact(const Matrix3& W, const Vector3& q, const CoulombLaw& law, bool was_sliding) {
  ContactAnswer answer;
  if (!(q[0] < 0.0)) return answer;  // separating without any impulse
  if (law.mu_static == 0.0) {
    answer.state = ContactState::kKinetic;
    answer.impulse[0] = -q[0] / W(0, 0);
    return answer;
  }
  const Vector3 sticking = -(W.inverse() * q);
  const double mu_stick = was_sliding ? law.mu_kinetic : law.mu_static;
  const Vector2 friction = sticking.tail<2>();
  if (sticking[0] > 0.0 && friction.norm() <= mu_stick * sticking[0]) {
    answer.state = ContactState::kStatic;
    answer.impulse = sticking;
    return answer;
  }
  return slide(W, q, law.mu_kinetic, friction);
}

}  // namespace tissue_contact
