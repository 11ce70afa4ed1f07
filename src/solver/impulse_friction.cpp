#include "solver/impulse_friction.h"

#include <utility>

namespace tissue_contact {
namespace {

SolverDescription asPredictorCorrector(SolverDescription description) {
  description.method = SolverMethod::kPredictorCorrector;
  return description;
}

/// Slows the sliding of one contact by at most mu lambda_n.
void applyFriction(const ContactProblem& problem, const ContactRow& row, Vector3& impulse, ContactState& state,
                   std::vector<NodalVectors>& v) {
  double mobility = 0.0;  // of the contact point by its nodes' masses, 1/kg
  for (int a = 0; a < row.node_count; ++a) {
    const RowNode& at = row.nodes[a];
    const BodySystem& body = problem.bodies[at.body];
    if (!(*body.fixed)[at.node]) mobility += at.weight * at.weight / body.mass[at.node];
  }
  const Vector2 sliding = relativeVelocity(row, v).tail<2>();
  const double speed = sliding.norm();
  if (!(mobility > 0.0) || !(speed > 0.0)) return;
  const double stopping = speed / mobility;
  const bool holds = stopping <= (row.was_sliding ? row.law.mu_kinetic : row.law.mu_static) * impulse[0];
  state = holds ? ContactState::kStatic : ContactState::kKinetic;
  impulse.tail<2>() = -(holds ? stopping : row.law.mu_kinetic * impulse[0]) / speed * sliding;
  const Vector3 friction_W = row.R_WC.rightCols<2>() * impulse.tail<2>();
  for (int a = 0; a < row.node_count; ++a) {
    const RowNode& at = row.nodes[a];
    const BodySystem& body = problem.bodies[at.body];
    if (!(*body.fixed)[at.node]) v[at.body].col(at.node) += at.weight / body.mass[at.node] * friction_W;
  }
}

}  // namespace

ImpulseFriction::ImpulseFriction(const SolverDescription& description, SecondsClock clock)
    : normal_(asPredictorCorrector(description), std::move(clock)) {}

SolverReport ImpulseFriction::solve(const ContactProblem& problem, ContactSolution& solution) {
  frictionless_ = problem;
  for (ContactRow& row : frictionless_.contacts) row.law = CoulombLaw();
  SolverReport report = normal_.solve(frictionless_, solution);
  for (std::size_t c = 0; c < problem.contacts.size(); ++c) {
    if (!(solution.impulses[c][0] > 0.0)) continue;
    applyFriction(problem, problem.contacts[c], solution.impulses[c], solution.states[c], solution.v);
  }
  scratch_.resize(problem.bodies.size());
  for (std::size_t k = 0; k < scratch_.size(); ++k) scratch_[k].resize(3, problem.bodies[k].K->rows());
  report.residuals = computeResiduals(problem, solution, scratch_);
  return report;
}

}  // namespace tissue_contact
