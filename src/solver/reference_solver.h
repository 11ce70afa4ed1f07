/// @file
/// Room `solver`, private: the reference. A Delassus problem in, an answer as exact as double precision allows out.
#pragma once

#include "tissue_contact/solver/delassus.h"

namespace tissue_contact {

/// Sweeps to come near, then Newton on the natural map, in turns, until the scaled natural map is <= tolerance or
/// description.iterations turns are over. Small problems on which that fails (large mu) start Newton from the answers
/// under 16- and 64-sided cones too. Two coefficients: each contact keeps the one of its state while Newton works;
/// contacts that slide under the static one change over, then Newton works again. With an anisotropic law: sweeps
/// alone, each contact solved exactly. @return sweeps and Newton steps made.
int solveReference(const DelassusProblem& problem, const SolverDescription& description, double tolerance,
                   DelassusSolution& solution);

}  // namespace tissue_contact
