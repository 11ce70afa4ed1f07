/// @file
/// Room `mesh` (private): from a polygon of a mesh file to triangles.
#pragma once

#include <vector>

#include "tissue_contact/core/types.h"

namespace tissue_contact {

/// Cuts a polygon into triangles of its corners, wound as it is, ear by ear (Meisters, Polygons have ears, 1975): no triangle has another corner
/// inside it or on its edges, but for corners in the same place (a hole that is joined with the border by an edge there and back), so that
/// those of a simple polygon are as many as its corners less two, none flat and no two on each other. It is looked at along the axis
/// nearest to its normal (Newell's: the sum of the edges' cross products). Of one that crosses itself, or whose corners all lie on a line, some
/// triangles. A quadrangle is cut from the corner that is not convex, else from the first.
/// Bounded: 3e8 comparisons of a corner with a triangle, a few seconds; a polygon of n corners, m of them not convex, takes some n m.
/// @param corners at least three, in any unit.
/// @throws std::invalid_argument saying how many corners it has, where that is not enough.
std::vector<Triangle> cutPolygon(const std::vector<Vector3>& corners);

}  // namespace tissue_contact
