/// @file
/// Room `baselines`: which solver takes a step's contact problem: the method (room solver), or what it is compared with.
#pragma once

#include <string>
#include <utility>

#include "tissue_contact/solver/solver_options.h"

namespace tissue_contact {

/// All but kPredictorCorrector and kReference are rivals kept for comparison.
enum class SolverMethod {
  kPredictorCorrector,  ///< the method: iterative predictor-corrector on ICA
  kReference,           ///< Delassus matrix by sparse Cholesky, semismooth Newton: exact and slow
  kCone4,               ///< ICA with the 4-sided cone compacted along the previous sliding velocity
  kPolyhedral,          ///< ICA with a polyhedral cone of `cone_sides` sides (MLCP)
  kCondensedLcp,        ///< static condensation to an LCP with a polyhedral cone, Lemke's pivoting
  kImpulse              ///< frictionless step, then friction impulses (Bridson, Fedkiw & Anderson 2002)
};

/// As scene files and command lines call them.
inline constexpr std::pair<const char*, SolverMethod> kSolverMethodNames[] = {
    {"predictor_corrector", SolverMethod::kPredictorCorrector},
    {"reference", SolverMethod::kReference},
    {"cone4", SolverMethod::kCone4},
    {"polyhedral", SolverMethod::kPolyhedral},
    {"condensed_lcp", SolverMethod::kCondensedLcp},
    {"impulse", SolverMethod::kImpulse}};

/// @throws std::invalid_argument for a number that is no SolverMethod.
const char* solverMethodName(SolverMethod method);
/// @throws std::invalid_argument naming the known ones.
SolverMethod solverMethodByName(const std::string& name);

/// Bounds of `cone_sides`, which must be even: a cone that resists both ways along each of its directions.
constexpr int kMinConeSides = 4;
constexpr int kMaxConeSides = 64;

struct SolverDescription : SolverOptions {
  SolverMethod method = SolverMethod::kPredictorCorrector;
  int cone_sides = 8;  ///< of kPolyhedral and kCondensedLcp
};

/// @throws std::invalid_argument as requireSolverOptions, and for sides a cone cannot have.
void requireSolver(const SolverDescription& description, const SecondsClock& clock);

}  // namespace tissue_contact
