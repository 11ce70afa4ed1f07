/// @file
/// Room `solver`, private: what is left of A v = b + J'lambda.
#pragma once

#include "tissue_contact/solver/contact_problem.h"

namespace tissue_contact {

/// b + J'lambda - A v of all nodes, N s; zero at fixed ones.
/// @param impulses J'lambda of the body.
/// @param defect may be `impulses` itself.
/// @return its squared norm, (N s)^2.
double bodyDefect(const BodySystem& body, const NodalVectors& v, const NodalVectors& impulses, NodalVectors& defect);

}  // namespace tissue_contact
