#include "solver/energy_guard.h"

#include <algorithm>
#include <cstddef>

#include "solver/momentum_defect.h"

namespace tissue_contact {

void EnergyGuard::shorten(const ContactProblem& problem, ContactSolution& solution) {
  impulses_.resize(problem.bodies.size());
  for (std::size_t k = 0; k < problem.bodies.size(); ++k) impulses_[k].setZero(3, problem.bodies[k].K->rows());
  for (std::size_t c = 0; c < problem.contacts.size(); ++c) {
    const ContactRow& row = problem.contacts[c];
    const Vector3 impulse_W = row.R_WC * solution.impulses[c];
    for (int a = 0; a < row.node_count; ++a)
      impulses_[row.nodes[a].body].col(row.nodes[a].node) += row.nodes[a].weight * impulse_W;
  }
  for (std::size_t k = 0; k < problem.bodies.size(); ++k) {
    const BodySystem& body = problem.bodies[k];
    if (body.asleep) continue;
    free_ = solution.v[k];
    for (const ContactRow& row : problem.contacts) {
      for (int a = 0; a < row.node_count; ++a) {
        if (row.nodes[a].body == static_cast<int>(k)) free_.col(row.nodes[a].node).setZero();
      }
    }
    bodyDefect(body, solution.v[k], impulses_[k], defect_);
    const double too_long = -defect_.cwiseProduct(free_).sum();
    if (!(too_long > 0.0)) continue;
    bodyDefect(body, free_, impulses_[k], defect_);
    const double energy = (body.b + impulses_[k] - defect_).cwiseProduct(free_).sum();
    const double share = energy > too_long ? too_long / energy : 1.0;
    solution.v[k] -= share * free_;
  }
}

}  // namespace tissue_contact
