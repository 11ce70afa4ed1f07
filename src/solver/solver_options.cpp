#include "tissue_contact/solver/solver_options.h"

#include <stdexcept>

#include "core/name_table.h"
#include "tissue_contact/core/check.h"

namespace tissue_contact {

const char* relaxationName(RelaxationKind relaxation) { return nameOf(relaxation, kRelaxationNames, "relaxation"); }

void requireSolverOptions(const SolverOptions& options, const SecondsClock& clock) {
  requirePositive("solver.iterations", options.iterations);
  requirePositive("solver.contact_passes", options.contact_passes);
  requirePositive("solver.tolerance", options.tolerance);
  requireNonNegative("solver.time_budget_s", options.time_budget_s, "s");
  if (options.time_budget_s > 0.0 && !clock) {
    throw std::invalid_argument(
        "solver.time_budget_s is set, but there is no clock here; leave it out, or give the simulator a clock");
  }
}

}  // namespace tissue_contact
