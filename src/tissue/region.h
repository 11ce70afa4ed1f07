/// @file
/// Room `tissue`, private: which region of a tissue a point lies in.
#pragma once

#include <vector>

#include "tissue_contact/core/types.h"
#include "tissue_contact/scene/scene.h"

namespace tissue_contact {

/// A distance (m) within which a point counts as on the boundary of a region: the rounding of coordinates such as 0.1 *
/// 3 in a mesh with nodes at x.
double roundingDistance(const NodalVectors& x);

/// For each point (3 x n, m, in T) the last region that holds it, -1 if none does. Boundaries count as inside.
std::vector<int> regionsOfPoints(const NodalVectors& points, const std::vector<TissueRegion>& regions, double rounding);

}  // namespace tissue_contact
