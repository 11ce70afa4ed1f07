/// @file
/// Room `solver`: how long and by which splitting the iteration on a step's contact problem goes on.
#pragma once

#include <functional>
#include <utility>

namespace tissue_contact {

/// What relaxes A v = b + J' lambda between the passes over the contacts.
enum class RelaxationKind {
  kGaussSeidel,  ///< block Gauss-Seidel sweeps: O(n) memory, right for small steps
  kCholesky      ///< lagged sparse Cholesky factor: for stiff or near-incompressible tissue and large steps
};

/// As scene files call them.
inline constexpr std::pair<const char*, RelaxationKind> kRelaxationNames[] = {
    {"gauss_seidel", RelaxationKind::kGaussSeidel}, {"cholesky", RelaxationKind::kCholesky}};

/// @throws std::invalid_argument for a number that is no RelaxationKind.
const char* relaxationName(RelaxationKind relaxation);

struct SolverOptions {
  RelaxationKind relaxation = RelaxationKind::kGaussSeidel;
  int iterations = 30;      ///< upper bound on iterations (relaxation + contact passes) per step
  int contact_passes = 20;  ///< upper bound on passes over the contacts per iteration
  /// Stop when an iteration changes momentum, and contacts' part of it, by less (relative to what changes velocities in the step and to the impulses), and all nodes together lack less
  /// than twice this of the load and the sum of the impulses. Leaves .03 to .7 % of error in six scenes (doc/notes/method.md).
  double tolerance = 1e-3;
  double time_budget_s = 0.0;  ///< stop after this wall time per step; 0: none. Gives up bit-identical replay
};

/// Seconds on a clock that never goes back. The core has none of its own: a time budget needs one from outside.
using SecondsClock = std::function<double()>;

/// @throws std::invalid_argument naming the option that is out of range, or a time budget without a clock.
void requireSolverOptions(const SolverOptions& options, const SecondsClock& clock);

}  // namespace tissue_contact
