/// @file
/// Room `mesh`, private: elements as a mesh file has them, and as simplices.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include "tissue_contact/core/types.h"

namespace tissue_contact {

/// Corners in Gmsh's order, those that it lacks -1: one of a point, two of a line, three of a triangle, four of a quadrangle or a tetrahedron,
/// five of a pyramid, six of a prism, eight of a hexahedron. VTK's order is the same but for voxels and for wedges, numbered from the other end.
using ElementCorners = std::array<int, 8>;

constexpr ElementCorners kNoCorners = {-1, -1, -1, -1, -1, -1, -1, -1};

std::size_t cornerCount(const ElementCorners& corners);

/// Adds a volume as tetrahedra, of its own orientation: itself, or one from its smallest node to each triangle of the faces that do not have
/// that node, where a quadrangle is split from its smallest node. So elements side by side agree about the diagonal between them (Dompierre,
/// Labbe, Vallet & Camarero 1999). What has collapsed between equal corners is left out; a tetrahedron stays as it is.
void addTetrahedra(const ElementCorners& corners, std::vector<Tetrahedron>& tetrahedra);

/// Adds a quadrangle as triangles, split in the same way.
void addTriangles(const ElementCorners& quadrangle, std::vector<Triangle>& triangles);

}  // namespace tissue_contact
