#include "baselines/newton.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <limits>

#include "baselines/delassus_states.h"
#include "baselines/natural_map.h"

namespace tissue_contact {
namespace {

/// The natural map of all contacts in natural units.
class ScaledMap {
 public:
  ScaledMap(const DelassusProblem& problem, const VectorX& mu)
      : units_(naturalUnits(problem)),
        W_(problem.W * (units_.impulse / units_.velocity)),
        q_(problem.q / units_.velocity),
        mu_(mu) {}

  double impulseUnit() const { return units_.impulse; }

  VectorX operator()(const VectorX& r) const {
    const VectorX u = W_ * r + q_;
    VectorX F(r.size());
    for (Eigen::Index c = 0; c < mu_.size(); ++c) {
      F.segment<3>(3 * c) = naturalMap(r.segment<3>(3 * c), u.segment<3>(3 * c), mu_[c]);
    }
    return F;
  }

  /// dF/dr = I - P'(x) (I - E W), x = r - u - mu |u_t| n, E = I + mu n u_t' / |u_t|.
  Eigen::MatrixXd jacobian(const VectorX& r) const {
    const VectorX u = W_ * r + q_;
    Eigen::MatrixXd J = Eigen::MatrixXd::Identity(r.size(), r.size());
    for (Eigen::Index c = 0; c < mu_.size(); ++c) {
      const Vector3 u_c = u.segment<3>(3 * c);
      const double speed = u_c.tail<2>().norm();
      Matrix3 E = Matrix3::Identity();
      if (speed > 0.0) E.block<1, 2>(0, 1) = mu_[c] / speed * u_c.tail<2>().transpose();
      Vector3 x = r.segment<3>(3 * c) - u_c;
      x[0] -= mu_[c] * speed;
      const Matrix3 P = coneProjectionDerivative(x, mu_[c]);
      J.middleRows<3>(3 * c).noalias() += P * E * W_.middleRows<3>(3 * c);
      J.block<3, 3>(3 * c, 3 * c) -= P;
    }
    return J;
  }

 private:
  NaturalUnits units_;
  Eigen::MatrixXd W_;
  VectorX q_;
  const VectorX& mu_;
};

/// Halves the step until |F| falls.
/// @return it fell.
bool backtrack(const ScaledMap& map, const VectorX& step, VectorX& r, VectorX& F) {
  constexpr int kMaxHalvings = 12;
  double length = 1.0;
  for (int halving = 0; halving <= kMaxHalvings; ++halving, length *= 0.5) {
    const VectorX trial = r + length * step;
    const VectorX F_trial = map(trial);
    if (F_trial.norm() <= (1.0 - 1e-4 * length) * F.norm()) {
      r = trial;
      F = F_trial;
      return true;
    }
  }
  return false;
}

struct NewtonReport {
  int steps = 0;
  double natural_map = 0.0;  ///< scaled, with the coefficients given
};

/// Minimises |F|^2 by Levenberg-Marquardt steps with a generalised Jacobian and backtracking: quadratic near a solution
/// even where W is singular and r not unique, because the regularisation vanishes with |F|. W need not be symmetric.
/// @param mu one coefficient per contact.
/// @param r in: start; out: the best point met, N s.
NewtonReport solveByNewton(const DelassusProblem& problem, const VectorX& mu, double tolerance, VectorX& r) {
  constexpr int kMostSteps = 20;
  constexpr double kLeastDamping = 1e-15;  // of J'J with entries about 1: keeps it positive definite in round-off
  constexpr int kPatience = 4;
  const ScaledMap map(problem, mu);
  VectorX scaled = r / map.impulseUnit();
  VectorX F = map(scaled);
  NewtonReport report;
  double damping = 1.0;
  double checkpoint = std::numeric_limits<double>::infinity();
  while (report.steps < kMostSteps && F.norm() > tolerance) {
    if (report.steps % kPatience == 0) {
      if (F.norm() > 0.5 * checkpoint) break;  // in a valley of |F|: only another start helps
      checkpoint = F.norm();
    }
    const Eigen::MatrixXd J = map.jacobian(scaled);
    Eigen::MatrixXd normal = J.transpose() * J;
    normal.diagonal().array() += std::max(damping * F.squaredNorm(), kLeastDamping);
    const VectorX step = -normal.llt().solve(J.transpose() * F);
    ++report.steps;
    damping = step.allFinite() && backtrack(map, step, scaled, F) ? std::max(0.1 * damping, 1e-4) : 100.0 * damping;
  }
  report.natural_map = F.norm();
  r = scaled * map.impulseUnit();
  return report;
}

}  // namespace

int finishByNewton(const DelassusProblem& problem, double tolerance, const DelassusSolution& start,
                   DelassusSolution& answer) {
  const double aim = 0.1 * tolerance;
  VectorX mu = chooseCoefficients(problem, start.states);
  VectorX r = start.r;
  int steps = 0;
  NewtonReport newton;
  do {
    newton = solveByNewton(problem, mu, aim, r);
    steps += newton.steps;
  } while (newton.natural_map <= aim && releaseSliding(problem, r, aim, mu));
  answer = answerWith(problem, mu, r, tolerance);
  return steps;
}

}  // namespace tissue_contact
