/// @file
/// Room `baselines`, private: static condensation, the rival that solves a Delassus problem as one big LCP.
#pragma once

#include "tissue_contact/baselines/delassus.h"

namespace tissue_contact {

/// All contacts at once with polyhedral cones of description.cone_sides sides (Stewart & Trinkle 1996; Anitescu & Potra
/// 1997), by Lemke's method with at most description.iterations pivots per unknown. Memory: (n (sides + 2))^2 doubles.
/// Isotropic contacts only. If pivoting fails, r = 0. Two coefficients: contacts that slide under the static one are
/// solved again with the kinetic one, until none is left.
/// @return pivots made.
int solveCondensedLcp(const DelassusProblem& problem, const SolverDescription& description, DelassusSolution& solution);

}  // namespace tissue_contact
