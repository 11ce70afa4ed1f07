/// @file
/// Room `solver`: what every solver of a step's contact problem offers. A contact problem and a warm start in;
/// velocities, impulses, states and a report out.
#pragma once

#include "tissue_contact/solver/contact_problem.h"

namespace tissue_contact {

/// Why a solver stopped.
enum class StopReason { kTolerance, kIterations, kTimeBudget };

struct SolverReport {
  int iterations = 0;
  StopReason stop = StopReason::kIterations;

  bool converged() const { return stop == StopReason::kTolerance; }
};

/// Holds its workspace: one object per thread. Deterministic unless a time budget is set.
class ContactSolver {
 public:
  virtual ~ContactSolver() = default;

  /// Fixed nodes keep v = 0.
  /// @param solution in: warm start (sizes must match the problem); out: the solution.
  virtual SolverReport solve(const ContactProblem& problem, ContactSolution& solution) = 0;

  /// Methods without a time budget take no notice.
  /// @param clock_s reading of the time budget's clock at which iterating stops, after one iteration at least; infinity,
  /// as at the start: never.
  /// @param prompt_s the same, but not before ten iterations: good enough and in time rather than better and late.
  /// @throws std::invalid_argument when either is not infinite and there is no clock.
  virtual void setDeadline([[maybe_unused]] double clock_s, [[maybe_unused]] double prompt_s) {}

  /// What is still missing from the impulses of the last solve() for the contact laws, as far as it can tell, N s: of each pair
  /// (ContactRow::pair) in all, magnitudes added over the pairs. 0 where what is left is in the momentum (Residuals::net_defect_n_s), and
  /// after reset(). Costs up to twenty passes over the contacts.
  /// @param problem, solution of the last solve().
  virtual double impulseLacking([[maybe_unused]] const ContactProblem& problem,
                                [[maybe_unused]] const ContactSolution& solution) {
    return 0.0;
  }

  /// Forgets what it carries from step to step (factors, caches): the next answer depends on its arguments alone.
  virtual void reset() {}
};

}  // namespace tissue_contact
