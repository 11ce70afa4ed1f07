#include "solver/delassus_lcp.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

#include "solver/delassus_states.h"
#include "solver/lemke.h"

namespace tissue_contact {
namespace {

/// Unknowns per contact: (r_n, beta_1 .. beta_sides, gamma), r = G (r_n, beta).
class CondensedLcp {
 public:
  CondensedLcp(const DelassusProblem& problem, int sides)
      : contacts_(problem.contacts()), per_contact_(sides + 2), units_(naturalUnits(problem)), G_(3, sides + 1) {
    G_.setZero();
    G_(0, 0) = 1.0;
    for (int k = 0; k < sides; ++k) {
      const double angle = 2.0 * M_PI * k / sides;
      G_.col(k + 1) = Vector3(0.0, std::cos(angle), std::sin(angle));
    }
    const Eigen::Index size = contacts_ * per_contact_;
    constexpr Eigen::Index kMostUnknowns = 8000;  // a tableau of half a gigabyte, minutes of pivoting
    if (size > kMostUnknowns) {
      throw std::invalid_argument("condensed_lcp: " + std::to_string(size) +
                                  " unknowns (contacts times cone sides + 2); at "
                                  "most " +
                                  std::to_string(kMostUnknowns) + "; take fewer sides, or another method");
    }
    tableau_.resize(size, size + 2);
    labels_.resize(2 * size + 1);
    z_.resize(size);
  }

  Eigen::Index unknowns() const { return z_.size(); }

  /// @return pivots made. r: the answer, N s, 0 where there is none.
  int solve(const DelassusProblem& problem, const VectorX& mu, int max_pivots, VectorX& r) {
    fill(problem, mu);
    const LcpAnswer answer = solveLcp(tableau_, labels_, z_, max_pivots);
    r.setZero(3 * contacts_);
    if (answer.status != LcpStatus::kSolved) return answer.pivots;
    for (Eigen::Index c = 0; c < contacts_; ++c) {
      r.segment<3>(3 * c) = units_.impulse * (G_ * z_.segment(first(c), G_.cols()));
    }
    return answer.pivots;
  }

 private:
  Eigen::Index first(Eigen::Index contact) const { return contact * per_contact_; }

  void fill(const DelassusProblem& problem, const VectorX& mu) {
    const Eigen::Index sides = per_contact_ - 2;
    const double scale = units_.impulse / units_.velocity;
    tableau_.setZero();
    for (Eigen::Index c = 0; c < contacts_; ++c) {
      const Eigen::Index row = first(c);
      for (Eigen::Index d = 0; d < contacts_; ++d) {
        tableau_.block(row, first(d), sides + 1, sides + 1).noalias() =
            G_.transpose() * (scale * problem.W.block<3, 3>(3 * c, 3 * d)) * G_;
      }
      tableau_.block(row + 1, row + sides + 1, sides, 1).setOnes();
      tableau_.block(row + sides + 1, row + 1, 1, sides).setConstant(-1.0);
      tableau_(row + sides + 1, row) = mu[c];
      tableau_.col(unknowns() + 1).segment(row, sides + 1) =
          G_.transpose() * problem.q.segment<3>(3 * c) / units_.velocity;
    }
  }

  Eigen::Index contacts_;
  Eigen::Index per_contact_;
  NaturalUnits units_;
  Eigen::Matrix<double, 3, Eigen::Dynamic> G_;
  Eigen::MatrixXd tableau_;
  Eigen::VectorXi labels_;
  VectorX z_;
};

}  // namespace

int solveCondensedLcp(const DelassusProblem& problem, const SolverDescription& description,
                      DelassusSolution& solution) {
  if (problem.contacts() == 0) return 0;
  constexpr double kRoundOff = 1e-10;  // sliding left by pivoting, natural units
  CondensedLcp lcp(problem, description.cone_sides);
  const double bound = static_cast<double>(description.iterations) * static_cast<double>(lcp.unknowns());
  const int max_pivots = static_cast<int>(std::min(bound, 1e9));
  VectorX mu = chooseCoefficients(problem, {});
  VectorX r;
  int pivots = 0;
  do {
    pivots += lcp.solve(problem, mu, max_pivots, r);
  } while (releaseSliding(problem, r, kRoundOff, mu));
  solution = answerWith(problem, mu, r, kRoundOff);
  return pivots;
}

}  // namespace tissue_contact
