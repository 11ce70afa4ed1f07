/// @file
/// Room `baselines`, private: a semismooth Newton method on the natural map of a whole Delassus problem.
#pragma once

#include "tissue_contact/baselines/delassus.h"

namespace tissue_contact {

/// Isotropic laws only. Contacts that slide under their static coefficient change over to the kinetic one until all are
/// consistent.
/// @param tolerance of the scaled natural map.
/// @param answer of Newton, also where it has not met the tolerance.
/// @return steps made.
int finishByNewton(const DelassusProblem& problem, double tolerance, const DelassusSolution& start,
                   DelassusSolution& answer);

}  // namespace tissue_contact
