#include "solver/contact_corrector.h"

#include <algorithm>

namespace tissue_contact {

void ContactCorrector::prepare(std::size_t contacts, const std::function<Vector2(std::size_t)>& sliding) {
  flips_.assign(contacts, 0);
  held_.assign(contacts, Held::kNo);
  if (!rival_) return;
  previous_sliding_.resize(contacts);
  for (std::size_t c = 0; c < contacts; ++c) previous_sliding_[c] = sliding(c);
}

void ContactCorrector::hold(const ContactProblem& problem) {
  if (rival_) return;
  for (std::size_t c = 0; c < held_.size(); ++c) {
    const ContactRow& row = problem.contacts[c];
    if (row.was_static && holdsMoreAtRest(row.law)) held_[c] = Held::kYes;
  }
}

bool ContactCorrector::releaseOverloaded() {
  const bool some = std::find(held_.begin(), held_.end(), Held::kAtLimit) != held_.end();
  std::replace(held_.begin(), held_.end(), Held::kAtLimit, Held::kNo);
  return some;
}

bool ContactCorrector::releaseAll() {
  const bool some = releaseOverloaded();
  std::fill(held_.begin(), held_.end(), Held::kNo);
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
