/// @file
/// Room `mesh`, private: which points lie in a region.
#pragma once

#include <array>
#include <string>
#include <vector>

#include "tissue_contact/core/types.h"
#include "tissue_contact/mesh/region_description.h"

namespace tissue_contact {

/// A distance (m) within which a point counts as on the boundary of a region: the rounding of coordinates such as 0.1 *
/// 3 in a mesh with nodes at x.
double roundingDistance(const NodalVectors& x);

/// What the places of a MemberRegion are sorted by: how far they lie along a direction in which nodes of structured meshes, which share
/// coordinates by the thousand, hardly ever lie side by side.
double placeOrder(const Vector3& place);

/// Whether any of the regions holds the point (m, in T). Boundaries count as inside.
bool anyHolds(const std::vector<Region>& regions, const Vector3& x, double rounding);

/// Whether a region holds the point (m, in T), its boundary included.
bool holds(const Region& region, const Vector3& x, double rounding);

/// Whether a region may hold a point within a distance (m) of x: true as well where that is not known, of groups and cell data.
bool mayHoldWithin(const Region& region, const Vector3& x, double distance);

/// Whether the border of what the regions hold runs through a tetrahedron, not only along its faces: as its corners show it, or 35 places
/// inside it, an eighth of its height from its faces.
/// @param regions boxes, planes and spheres; groups and cell data are of whole elements, and are to be left out.
bool bordersIn(const std::vector<Region>& regions, const std::array<Vector3, 4>& corners, double rounding);

/// For each point (3 x n, m, in T) whether any of the regions holds it.
/// @param entry of the regions in their tissue, "fixed". @param what a point is, "node".
/// @throws EntryError naming `source`, the region and the extent of the points when a region holds none.
std::vector<bool> heldPoints(const NodalVectors& points, const std::vector<Region>& regions, const std::string& entry,
                             const std::string& what, const std::string& source);

}  // namespace tissue_contact
