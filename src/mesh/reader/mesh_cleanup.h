/// @file
/// Room `mesh` (private): from the triangle soup of a mesh file to a connected, outward surface.
#pragma once

#include <vector>

#include "tissue_contact/core/types.h"
#include "tissue_contact/mesh/triangle_mesh.h"

namespace tissue_contact {

constexpr double kFlatArea = 1e-10;  ///< of the longest edge squared: below it a triangle is flat

/// Merges vertices nearer to each other than 1e-7 of the bounding box's diagonal, or, as far as that is a thousandth of the shortest edge, than
/// single precision resolves at their distance from the origin (firstInPlace()): STL repeats every vertex per
/// triangle, and mesh files store single precision, so equal points may differ in the last digit after a node's
/// transform. The first of each group is kept, and triangles left with two equal corners are dropped. Linear in the
/// number of vertices.
/// @param vertices finite.
TriangleMesh mergeVertices(const std::vector<Vector3>& vertices, const std::vector<Triangle>& triangles);

/// Gives every closed, orientable connected part one orientation and a positive enclosed volume, and so every such part with
/// holes of up to some 1 % of its area, whose sign is clear without them; other parts stay as they are, since nothing tells
/// their outside. Of a closed part that stands there twice, once each way round, one is left.
void orientOutward(TriangleMesh& mesh);

/// Drops triangles whose corners lie on a line (kFlatArea). Call it after
/// orientOutward(): such a triangle may well close a surface.
void dropFlatTriangles(TriangleMesh& mesh);

}  // namespace tissue_contact
