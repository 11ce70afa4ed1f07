/// @file
/// Room `solver`, private: a semismooth Newton method on the natural map of a whole Delassus problem.
#pragma once

#include "solver/natural_map.h"

namespace tissue_contact {

struct NewtonReport {
  int steps = 0;
  double natural_map = 0.0;  ///< scaled, with the coefficients given
};

/// Minimises |F|^2 of the scaled natural map by Levenberg-Marquardt steps with a generalised Jacobian and backtracking:
/// quadratic near an answer even where W is singular and r not unique, because the regularisation vanishes with |F|.
/// Isotropic contacts only. W need not be symmetric.
/// @param mu one coefficient per contact. @param r in: start; out: the best point met, N s.
NewtonReport solveByNewton(const DelassusProblem& problem, const VectorX& mu, double tolerance, int max_steps,
                           VectorX& r);

}  // namespace tissue_contact
