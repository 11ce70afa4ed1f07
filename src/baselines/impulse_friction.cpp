#include "baselines/step_solvers.h"
#include "solver/iterative_predictor_corrector.h"

namespace tissue_contact {
namespace {

/// Slows the sliding of one contact by at most mu lambda_n.
void applyFriction(const ContactProblem& problem, const ContactRow& row, Vector3& impulse, ContactState& state,
                   std::vector<NodalVectors>& v) {
  double mobility = 0.0;  // of the contact point by its nodes' masses, 1/kg
  for (int a = 0; a < row.node_count; ++a) {
    const RowNode& at = row.nodes[a];
    const BodySystem& body = problem.bodies[at.body];
    if (!(*body.fixed)[at.node]) mobility += at.weight * at.weight / body.mass[at.node];
  }
  if (mobility > 0.0) mobility += row.tangential_compliance;
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

class ImpulseFriction : public IterativePredictorCorrector {
 public:
  using IterativePredictorCorrector::IterativePredictorCorrector;

  SolverReport solve(const ContactProblem& problem, ContactSolution& solution) override {
    frictionless_ = problem;
    for (ContactRow& row : frictionless_.contacts) row.law = CoulombLaw();
    const SolverReport report = IterativePredictorCorrector::solve(frictionless_, solution);
    for (std::size_t c = 0; c < problem.contacts.size(); ++c) {
      if (!(solution.impulses[c][0] > 0.0)) continue;
      applyFriction(problem, problem.contacts[c], solution.impulses[c], solution.states[c], solution.v);
    }
    return report;
  }
  double impulseLacking(const ContactProblem&, const ContactSolution&) override {
    return 0.0;
  }  // it is to lack friction

 private:
  ContactProblem frictionless_;
};

}  // namespace

std::unique_ptr<ContactSolver> makeImpulseFriction(const SolverOptions& options, const SecondsClock& clock) {
  return std::make_unique<ImpulseFriction>(options, clock);
}

}  // namespace tissue_contact
