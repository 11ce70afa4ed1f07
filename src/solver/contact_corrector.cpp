#include "solver/contact_corrector.h"

namespace tissue_contact {

void ContactCorrector::prepare(const ContactProblem& problem, const ContactSolution& solution) {
  flips_.assign(problem.contacts.size(), 0);
  if (method_ == SolverMethod::kPredictorCorrector) return;
  previous_sliding_.resize(problem.contacts.size());
  for (std::size_t c = 0; c < problem.contacts.size(); ++c) {
    previous_sliding_[c] = relativeVelocity(problem.contacts[c], solution.v).tail<2>();
  }
}

Vector3 ContactCorrector::correct(const ContactProblem& problem, std::size_t contact, const Matrix3& W,
                                  const Vector3& u, ContactSolution& solution) {
  const ContactRow& row = problem.contacts[contact];
  Vector3& impulse = solution.impulses[contact];
  Vector3 q = u - W * impulse;
  q[0] -= row.required_u_n;
  const bool kinetic_limit = row.was_sliding || flips_[contact] > kMaxFlips;
  const ContactAnswer answer =
      method_ == SolverMethod::kPredictorCorrector
          ? solveCoulombContact(W, q, row.law, kinetic_limit)
          : solveRivalContact(method_, cone_sides_, W, q, row.law, kinetic_limit, previous_sliding_[contact]);
  ContactState& state = solution.states[contact];
  const bool both_touch = answer.state != ContactState::kOpen && state != ContactState::kOpen;
  if (both_touch && answer.state != state && flips_[contact] <= kMaxFlips) ++flips_[contact];
  state = answer.state;
  Vector3 change = answer.impulse - impulse;
  impulse = answer.impulse;
  return change;
}

}  // namespace tissue_contact
