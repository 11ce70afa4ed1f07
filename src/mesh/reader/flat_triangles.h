/// @file
/// Room `mesh` (private): flat triangles of a surface, with which some programs close the gap beside a corner that lies on an edge.
#pragma once

#include "tissue_contact/mesh/triangle_mesh.h"

namespace tissue_contact {

/// Cuts the neighbour across the longest edge of a flat triangle in two at the third corner, in place of the two, so that the surface hangs
/// together there without it (an edge flip). Flat: its height is below 2e-10 of the longest edge, or, as far as that is a thousandth of it, what
/// single precision resolves at the distance from the origin. Stays as it is where the longest edge does not have exactly one other triangle,
/// where that is flat, too, or the two would be flat, turned over or share an edge with a third. All others keep their bits and places.
/// Linear in the number of triangles, but for a logarithm.
/// @pre vertices finite, triangles of three different vertices each (mergeVertices()).
void absorbFlatTriangles(TriangleMesh& mesh);

}  // namespace tissue_contact
