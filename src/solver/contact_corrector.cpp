#include "solver/contact_corrector.h"

namespace tissue_contact {

void ContactCorrector::prepare(std::size_t contacts, const std::function<Vector2(std::size_t)>& sliding) {
  past_.assign(contacts, Past());
  if (!rival_) return;
  previous_sliding_.resize(contacts);
  for (std::size_t c = 0; c < contacts; ++c) previous_sliding_[c] = sliding(c);
}

void ContactCorrector::hold(const ContactProblem& problem) {
  if (rival_) return;
  for (std::size_t c = 0; c < past_.size(); ++c) {
    const ContactRow& row = problem.contacts[c];
    if (row.was_static && holdsMoreAtRest(row.law)) past_[c].held = Held::kYes;
  }
}

bool ContactCorrector::releaseOverloaded() {
  bool some = false;
  for (Past& past : past_) {
    if (past.held != Held::kAtLimit) continue;
    past.held = Held::kNo;
    some = true;
  }
  return some;
}

bool ContactCorrector::releaseAll() {
  const bool some = releaseOverloaded();
  for (Past& past : past_) past.held = Held::kNo;
  return some;
}

Vector3 ContactCorrector::correct(const ContactProblem& problem, std::size_t contact, const Matrix3& W,
                                  const Vector3& u, ContactSolution& solution) {
  const ContactRow& row = problem.contacts[contact];
  Vector3& impulse = solution.impulses[contact];
  ContactState& state = solution.states[contact];
  Vector3 q = u - W * impulse;
  q[0] += row.normal_compliance * impulse[0] - row.required_u_n;
  q.tail<2>() += row.tangential_compliance * impulse.tail<2>();
  const ContactAnswer answer = solve(contact, W, q, row.law, row.was_sliding, state);
  Vector3 change = answer.impulse - impulse;
  impulse = answer.impulse;
  state = answer.state;
  return change;
}

}  // namespace tissue_contact
