#include "tissue_contact/baselines/make_contact_solver.h"

#include <string>

#include "baselines/rival_contact.h"
#include "baselines/step_solvers.h"
#include "core/name_table.h"
#include "solver/iterative_predictor_corrector.h"
#include "tissue_contact/core/check.h"

namespace tissue_contact {

const char* solverMethodName(SolverMethod method) { return nameOf(method, kSolverMethodNames, "solver method"); }

SolverMethod solverMethodByName(const std::string& name) { return valueOf(name, kSolverMethodNames, "solver method"); }

void requireSolver(const SolverDescription& description, const SecondsClock& clock) {
  requireSolverOptions(description, clock);
  const int sides = description.cone_sides;
  if (sides >= kMinConeSides && sides <= kMaxConeSides && sides % 2 == 0) return;
  throwBadValue("solver.cone_sides", sides, "",
                "even, from " + std::to_string(kMinConeSides) + " to " + std::to_string(kMaxConeSides));
}

std::unique_ptr<ContactSolver> makeContactSolver(const SolverDescription& description, const SecondsClock& clock) {
  requireSolver(description, clock);
  switch (description.method) {
    case SolverMethod::kReference:
    case SolverMethod::kCondensedLcp:
      return makeDelassusStepSolver(description);
    case SolverMethod::kImpulse:
      return makeImpulseFriction(description, clock);
    default:
      return std::make_unique<IterativePredictorCorrector>(description, clock, rivalContactSolver(description));
  }
}

}  // namespace tissue_contact
