#include "tissue_contact/solver/contact_solver.h"

#include <stdexcept>

#include "solver/delassus_step_solver.h"
#include "solver/impulse_friction.h"
#include "tissue_contact/core/check.h"
#include "tissue_contact/solver/iterative_predictor_corrector.h"

namespace tissue_contact {

void requireSolverOptions(const SolverDescription& description, const SecondsClock& clock) {
  requirePositive("solver.iterations", description.iterations);
  requirePositive("solver.contact_passes", description.contact_passes);
  requirePositive("solver.tolerance", description.tolerance);
  requireNonNegative("solver.time_budget_s", description.time_budget_s, "s");
  if (description.cone_sides < 4 || description.cone_sides > 64 || description.cone_sides % 2 != 0) {
    throwBadValue("solver.cone_sides", description.cone_sides, "", "even, from 4 to 64");
  }
  if (description.time_budget_s > 0.0 && !clock) {
    throw std::invalid_argument(
        "solver.time_budget_s is set, but there is no clock here; leave it out, or give the simulator a clock");
  }
}

std::unique_ptr<ContactSolver> makeContactSolver(const SolverDescription& description, const SecondsClock& clock) {
  requireSolverOptions(description, clock);
  switch (description.method) {
    case SolverMethod::kReference:
    case SolverMethod::kCondensedLcp:
      return std::make_unique<DelassusStepSolver>(description);
    case SolverMethod::kImpulse:
      return std::make_unique<ImpulseFriction>(description, clock);
    default:
      return std::make_unique<IterativePredictorCorrector>(description, clock);
  }
}

}  // namespace tissue_contact
