#include "baselines/delassus_states.h"

#include <algorithm>

#include "baselines/natural_map.h"

namespace tissue_contact {
namespace {

ContactState stateOf(const Vector3& r, const Vector3& u, double mu, const NaturalUnits& units, double round_off) {
  const double normal = r[0] / units.impulse;
  if (!(normal > u[0] / units.velocity)) return ContactState::kOpen;
  const double unused = mu * normal - r.tail<2>().norm() / units.impulse;
  const bool slides = u.tail<2>().norm() / units.velocity > std::max(unused, round_off);
  return slides || mu == 0.0 ? ContactState::kKinetic : ContactState::kStatic;
}

}  // namespace

VectorX chooseCoefficients(const DelassusProblem& problem, const std::vector<ContactState>& states) {
  VectorX mu(problem.contacts());
  for (Eigen::Index c = 0; c < problem.contacts(); ++c) {
    const bool sliding = problem.was_sliding[c] || (!states.empty() && states[c] == ContactState::kKinetic);
    mu[c] = sliding ? problem.laws[c].mu_kinetic : problem.laws[c].mu_static;
  }
  return mu;
}

bool releaseSliding(const DelassusProblem& problem, const VectorX& r, double round_off, VectorX& mu) {
  const NaturalUnits units = naturalUnits(problem);
  const VectorX u = problem.W * r + problem.q;
  bool released = false;
  for (Eigen::Index c = 0; c < problem.contacts(); ++c) {
    const double kinetic = problem.laws[c].mu_kinetic;
    if (mu[c] == kinetic) continue;
    if (stateOf(r.segment<3>(3 * c), u.segment<3>(3 * c), mu[c], units, round_off) != ContactState::kKinetic) continue;
    mu[c] = kinetic;
    released = true;
  }
  return released;
}

DelassusSolution answerWith(const DelassusProblem& problem, const VectorX& mu, const VectorX& r, double round_off) {
  const NaturalUnits units = naturalUnits(problem);
  DelassusSolution solution;
  solution.r = r;
  solution.u = problem.W * r + problem.q;
  solution.states.resize(problem.contacts());
  for (Eigen::Index c = 0; c < problem.contacts(); ++c) {
    solution.states[c] = stateOf(r.segment<3>(3 * c), solution.u.segment<3>(3 * c), mu[c], units, round_off);
  }
  return solution;
}

}  // namespace tissue_contact
