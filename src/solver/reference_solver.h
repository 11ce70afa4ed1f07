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

/// Semismooth Newton from `start`, contacts changing over to their kinetic coefficient until all are consistent. Isotropic
/// laws only. @param answer of Newton, also where it has not met the tolerance. @return steps made.
int finishByNewton(const DelassusProblem& problem, double tolerance, const DelassusSolution& start,
                   DelassusSolution& answer);

/// Another start for Newton where passes keep circling: the answer under 16-sided (turn 1) and 64-sided (turn 2) cones,
/// which a pivoting method finds wherever one is. @return false: too large for that, or no such turn.
bool startFromCones(const DelassusProblem& problem, int turn, DelassusSolution& start);

bool isotropic(const DelassusProblem& problem);  ///< all laws are

}  // namespace tissue_contact
