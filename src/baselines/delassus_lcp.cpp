#include "baselines/delassus_lcp.h"

#include <algorithm>
#include <stdexcept>
#include <string>

#include "baselines/delassus_states.h"
#include "baselines/lemke.h"
#include "baselines/natural_map.h"
#include "baselines/rival_contact.h"

namespace tissue_contact {
namespace {

/// Unknowns per contact: (r_n, beta_1 .. beta_sides, gamma), r = G (r_n, beta).
class CondensedLcp {
 public:
  CondensedLcp(const DelassusProblem& problem, int sides)
      : contacts_(problem.contacts()),
        per_contact_(sides + 2),
        units_(naturalUnits(problem)),
        G_(coneGenerators(sides)) {
    const Eigen::Index size = contacts_ * per_contact_;
    constexpr Eigen::Index kMostUnknowns = 8000;  // a tableau of half a gigabyte, minutes of pivoting
    if (size > kMostUnknowns) {
      throw std::invalid_argument("condensed_lcp: " + std::to_string(size) +
                                  " unknowns (contacts times cone sides + 2); at most " +
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
    if (!answer.solved) return answer.pivots;
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
      setConeConditions(tableau_.block(row, row, per_contact_, per_contact_), mu[c]);
      tableau_.col(unknowns() + 1).segment(row, sides + 1) =
          G_.transpose() * problem.q.segment<3>(3 * c) / units_.velocity;
    }
  }

  Eigen::Index contacts_;
  Eigen::Index per_contact_;
  NaturalUnits units_;
  ConeGenerators G_;
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
