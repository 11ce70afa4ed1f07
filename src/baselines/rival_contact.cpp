#include "baselines/rival_contact.h"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <limits>

#include "baselines/lemke.h"

namespace tissue_contact {
namespace {

/// Size of the smallest polygon (regular, first corner at `axis`, measured corner to centre) that holds f.
double polygonSize(const Vector2& f, const Vector2& axis, int sides) {
  const double half_side = M_PI / sides;
  const double angle = std::atan2(axis.x() * f.y() - axis.y() * f.x(), axis.dot(f));
  const double from_corner = std::abs(angle) - 2.0 * half_side * std::floor(std::abs(angle) / (2.0 * half_side));
  return f.norm() * std::cos(from_corner - half_side) / std::cos(half_side);
}

/// Open, frictionless or static contacts, which need no choice of a side.
/// @return false: the contact slides.
bool solveWithoutSliding(const Matrix3& W, const Vector3& q, const CoulombLaw& law, bool kinetic_limit,
                         const Vector2& axis, int sides, ContactAnswer& answer) {
  assert(law.anisotropic == nullptr);
  if (!(q[0] < 0.0)) return true;
  if (law.mu_static > 0.0) {
    const Vector3 sticking = -(W.inverse() * q);
    const double mu = kinetic_limit ? law.mu_kinetic : law.mu_static;
    if (sticking[0] > 0.0 && polygonSize(sticking.tail<2>(), axis, sides) <= mu * sticking[0]) {
      answer.state = ContactState::kStatic;
      answer.impulse = sticking;
      return true;
    }
  }
  answer.state = ContactState::kKinetic;
  answer.impulse = Vector3(-q[0] / W(0, 0), 0.0, 0.0);
  return !(law.mu_kinetic > 0.0);
}

/// A way to slide: impulse, and by how much it breaks the conditions for it (velocity, m/s; 0: consistent).
struct Candidate {
  Vector3 impulse = Vector3::Zero();
  double violation = std::numeric_limits<double>::infinity();
};

/// Sliding with the friction impulse at corner e of the diamond: u_n = 0 and no other corner would dissipate more.
Candidate slideAtCorner(const Matrix3& W, const Vector3& q, double mu, const Vector2& e) {
  Candidate candidate;
  const double bracket = W(0, 0) + mu * (W(0, 1) * e.x() + W(0, 2) * e.y());
  if (!(bracket > 0.0)) return candidate;
  candidate.impulse[0] = -q[0] / bracket;
  candidate.impulse.tail<2>() = mu * candidate.impulse[0] * e;
  const Vector2 u = (W * candidate.impulse + q).tail<2>();
  const double across = std::abs(e.x() * u.y() - e.y() * u.x());
  candidate.violation = std::max(0.0, u.dot(e) + across);
  return candidate;
}

/// Sliding with the friction impulse between corners e and f: u_n = 0 and no sliding along the side.
Candidate slideOnSide(const Matrix3& W, const Vector3& q, double mu, const Vector2& e, const Vector2& f) {
  Candidate candidate;
  const Vector2 side = f - e;
  const Vector3 per_normal(1.0, mu * e.x(), mu * e.y());  // r = r_n per_normal + share per_share
  const Vector3 per_share(0.0, mu * side.x(), mu * side.y());
  const Vector3 along(0.0, side.x(), side.y());
  Matrix2 system;
  system << W.row(0).dot(per_normal), W.row(0).dot(per_share), along.dot(W * per_normal), along.dot(W * per_share);
  const Vector2 solution = -(system.inverse() * Vector2(q[0], along.dot(q)));
  const double normal = solution[0];
  const double share = solution[1];
  if (!(normal > 0.0)) return candidate;
  candidate.impulse = normal * per_normal + share * per_share;
  const Vector2 u = (W * candidate.impulse + q).tail<2>();
  const double outside = std::max({0.0, -share, share - normal});
  candidate.violation = std::max(outside * mu * W.trace(), std::max(0.0, u.dot(e + f)));
  return candidate;
}

}  // namespace

ContactAnswer solveCone4Contact(const Matrix3& W, const Vector3& q, const CoulombLaw& law, bool kinetic_limit,
                                const Vector2& previous_sliding) {
  const double speed = previous_sliding.norm();
  const Vector2 axis = speed > 0.0 ? Vector2(previous_sliding / speed) : Vector2::UnitX();
  ContactAnswer answer;
  if (solveWithoutSliding(W, q, law, kinetic_limit, axis, 4, answer)) return answer;
  const Vector2 across(-axis.y(), axis.x());
  const std::array<Vector2, 4> corners = {-axis, -across, axis, across};  // straight on first: the likely one
  Candidate best;
  const auto offer = [&best](const Candidate& candidate) {
    if (candidate.violation < best.violation) best = candidate;
  };
  for (const Vector2& corner : corners) offer(slideAtCorner(W, q, law.mu_kinetic, corner));
  for (int i = 0; i < 4; ++i) offer(slideOnSide(W, q, law.mu_kinetic, corners[i], corners[(i + 1) % 4]));
  if (std::isfinite(best.violation)) answer.impulse = best.impulse;
  return answer;
}

ConeGenerators coneGenerators(int sides) {
  ConeGenerators generators(3, sides + 1);
  generators.col(0) = Vector3::UnitX();
  for (int k = 0; k < sides; ++k) {
    const double angle = 2.0 * M_PI * k / sides;
    generators.col(k + 1) = Vector3(0.0, std::cos(angle), std::sin(angle));
  }
  return generators;
}

void setConeConditions(Eigen::Ref<Eigen::MatrixXd> block, double mu) {
  const Eigen::Index sides = block.rows() - 2;
  block.block(1, sides + 1, sides, 1).setOnes();
  block.block(sides + 1, 1, 1, sides).setConstant(-1.0);
  block(sides + 1, 0) = mu;
}

ContactAnswer solvePolyhedralContact(const Matrix3& W, const Vector3& q, const CoulombLaw& law, bool kinetic_limit,
                                     int sides) {
  assert(sides >= kMinConeSides && sides <= kMaxConeSides);
  ContactAnswer answer;
  if (solveWithoutSliding(W, q, law, kinetic_limit, Vector2::UnitX(), sides, answer)) return answer;
  constexpr int kMax = kMaxConeSides + 2;
  const double compliance = W.trace() / 3.0;  // unknowns are r * compliance / speed: all numbers about 1
  const double speed = q.norm();
  const int n = sides + 2;
  const ConeGenerators generators = coneGenerators(sides);
  Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, kMax, kMax + 2> tableau(n, n + 2);
  tableau.setZero();
  tableau.topLeftCorner(sides + 1, sides + 1) = generators.transpose() * (W / compliance) * generators;
  setConeConditions(tableau.leftCols(n), law.mu_kinetic);
  tableau.col(n + 1).head(sides + 1) = generators.transpose() * (q / speed);
  Eigen::Matrix<int, Eigen::Dynamic, 1, 0, 2 * kMax + 1> labels(2 * n + 1);
  Eigen::Matrix<double, Eigen::Dynamic, 1, 0, kMax> z(n);
  const LcpAnswer lcp = solveLcp(tableau, labels, z, 50 * n);
  if (lcp.solved) answer.impulse = generators * z.head(sides + 1) * (speed / compliance);
  if (!(answer.impulse[0] > 0.0)) answer = ContactAnswer();
  return answer;
}

ContactRival rivalContactSolver(const SolverDescription& description) {
  if (description.method == SolverMethod::kCone4) return solveCone4Contact;
  if (description.method != SolverMethod::kPolyhedral) return nullptr;
  return [sides = description.cone_sides](const Matrix3& W, const Vector3& q, const CoulombLaw& law, bool kinetic_limit,
                                          const Vector2& /*previous_sliding*/) {
    return solvePolyhedralContact(W, q, law, kinetic_limit, sides);
  };
}

}  // namespace tissue_contact
