/// @file
/// Room `solver`, private: the rival that treats friction after the step: a frictionless solve, then one friction impulse
/// per contact on the velocities it left (Bridson, Fedkiw & Anderson, "Robust treatment of collisions, contact and
/// friction for cloth animation", SIGGRAPH 2002, section 7.2, with the effective mass of the contact's nodes alone).
/// The impulses never meet the elastic forces of the step, so A v = b + J'lambda holds no longer.
#pragma once

#include "tissue_contact/solver/iterative_predictor_corrector.h"

namespace tissue_contact {

class ImpulseFriction : public ContactSolver {
 public:
  ImpulseFriction(const SolverDescription& description, SecondsClock clock);

  SolverReport solve(const ContactProblem& problem, ContactSolution& solution) override;
  void setDeadline(double clock_s, double prompt_s) override { normal_.setDeadline(clock_s, prompt_s); }
  void reset() override { normal_.reset(); }
  Memory memory() const override { return normal_.memory(); }

 private:
  IterativePredictorCorrector normal_;
  ContactProblem frictionless_;
  std::vector<NodalVectors> scratch_;
};

}  // namespace tissue_contact
