/// @file
/// Room `solver`: what every solver of a step's contact problem offers. A contact problem and a warm start in;
/// velocities, impulses, states and a report out.
#pragma once

#include <functional>
#include <memory>

#include "tissue_contact/scene/scene.h"
#include "tissue_contact/solver/contact_problem.h"
#include "tissue_contact/solver/residuals.h"

namespace tissue_contact {

/// Why a solver stopped.
enum class StopReason { kTolerance, kIterations, kTimeBudget };

struct SolverReport {
  int iterations = 0;
  StopReason stop = StopReason::kIterations;
  Residuals residuals;  ///< after the last sweep

  bool converged() const { return stop == StopReason::kTolerance; }
};

/// Seconds on a clock that never goes back. The core has none of its own: a time budget needs one from outside.
using SecondsClock = std::function<double()>;

/// Holds its workspace: one object per thread. Deterministic unless a time budget is set.
class ContactSolver {
 public:
  virtual ~ContactSolver() = default;

  /// @param solution in: warm start (sizes must match the problem); out: the answer. Fixed nodes keep v = 0.
  virtual SolverReport solve(const ContactProblem& problem, ContactSolution& solution) = 0;

  /// Stop iterating once the clock of the time budget shows `clock_s` (infinity, as at the start: never), after one
  /// iteration at least. Methods without a time budget take no notice.
  /// @param prompt_s the same, but not before ten iterations: good enough and in time rather than better and late.
  /// @throws std::invalid_argument when either is not infinite and there is no clock.
  virtual void setDeadline(double clock_s, double prompt_s) {
    static_cast<void>(clock_s);
    static_cast<void>(prompt_s);
  }

  /// Forgets what it carries from step to step (factors, caches): the next answer depends on its arguments alone.
  virtual void reset() {}

  /// Bytes held now for nodes and for contacts, capacity included.
  struct Memory {
    std::size_t per_nodes = 0;     ///< bytes in all that grow with the number of nodes
    std::size_t per_contacts = 0;  ///< bytes in all that grow with the number of contacts
  };
  virtual Memory memory() const = 0;
};

/// @throws std::invalid_argument naming the option that is out of range, or a time budget without a clock.
void requireSolverOptions(const SolverDescription& description, const SecondsClock& clock);

/// The solver a scene asks for. @param clock needed only for a time budget.
/// @throws std::invalid_argument as requireSolverOptions.
std::unique_ptr<ContactSolver> makeContactSolver(const SolverDescription& description,
                                                 const SecondsClock& clock = nullptr);

}  // namespace tissue_contact
