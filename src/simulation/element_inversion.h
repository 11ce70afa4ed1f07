/// @file
/// Room `simulation`, private: how far the nodes of a tissue may go before they turn elements inside out.
#pragma once

#include <vector>

#include "tissue_contact/core/types.h"
#include "tissue_contact/tissue/tissue.h"

namespace tissue_contact {

/// The first of 1, .7 and .5 after which no element that holds more than a tenth of its volume at rest would hold less than
/// a twentieth, had its nodes gone that share of dt v; .5 where none is. Elements that hold less already are not looked at,
/// or one that is crushed at an edge would stop the tissue. 1 where there are no tetrahedra.
///
/// The bound on a step's length of mesh optimisation (Smith & Schaefer 2015, "Bijective parameterization with free
/// boundaries", section 3.3), by trial in place of roots.
/// @param x m, @param v m/s, 3 x nodes; finite. @param is_fast scratch; grows only for more nodes than ever before.
double shareBeforeInversion(const Tissue& tissue, const NodalVectors& x, const NodalVectors& v, double dt_s,
                            std::vector<char>& is_fast);

}  // namespace tissue_contact
