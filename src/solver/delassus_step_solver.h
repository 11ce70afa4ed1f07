/// @file
/// Room `solver`, private: solvers that work on the Delassus matrix (reference, static condensation), applied to a
/// step. Exact and slow: every step factors A and fills W. They measure the error of the others.
#pragma once

#include "tissue_contact/solver/contact_solver.h"
#include "tissue_contact/solver/delassus.h"

namespace tissue_contact {

class DelassusStepSolver : public ContactSolver {
 public:
  explicit DelassusStepSolver(const SolverDescription& description) : description_(description) {}

  SolverReport solve(const ContactProblem& problem, ContactSolution& solution) override;
  Memory memory() const override { return memory_; }

 private:
  SolverReport solveExactly(const ContactProblem& problem, ContactSolution& solution);

  SolverDescription description_;
  Memory memory_;
  std::vector<NodalVectors> scratch_;
};

}  // namespace tissue_contact
