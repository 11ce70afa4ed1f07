/// @file
/// Room `mesh`, private: which points lie in a region.
#pragma once

#include <vector>

#include "tissue_contact/core/types.h"
#include "tissue_contact/mesh/region_description.h"

namespace tissue_contact {

/// A distance (m) within which a point counts as on the boundary of a region: the rounding of coordinates such as 0.1 *
/// 3 in a mesh with nodes at x.
double roundingDistance(const NodalVectors& x);

/// Whether any of the regions holds the point (m, in T). Boundaries count as inside.
bool anyHolds(const std::vector<Region>& regions, const Vector3& x, double rounding);

}  // namespace tissue_contact
