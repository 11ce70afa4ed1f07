/// @file
/// Room `simulation`, private: how far the nodes of a tissue may go before they turn elements inside out.
#pragma once

#include <vector>

#include "tissue_contact/core/types.h"
#include "tissue_contact/tissue/tissue.h"

namespace tissue_contact {

/// Share, in [0.5, 1], of the way dt v from x that takes no element from more than a tenth of its volume at rest to less than a twentieth,
/// within a factor of .7; half of the way where that is not enough. Elements that hold less already have no say, or one that is crushed at an edge would stop the tissue. 1 where there
/// are no tetrahedra. The bound on a step's length of mesh optimisation (Smith & Schaefer 2015, "Bijective parameterization with free
/// boundaries", section 3.3), by trial in place of roots: the way of a step is mostly far below it.
/// @param x m, @param v m/s, 3 x nodes; finite. Allocates only for more nodes than ever before.
/// @param is_fast scratch.
double shareBeforeInversion(const Tissue& tissue, const NodalVectors& x, const NodalVectors& v, double dt_s,
                            std::vector<char>& is_fast);

}  // namespace tissue_contact
