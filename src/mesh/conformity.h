/// @file
/// Room `mesh`, private: whether tetrahedra that lie side by side hang together: a mesh is conforming where two that meet share a whole face.
#pragma once

#include <cstddef>
#include <string>

#include "tissue_contact/mesh/tet_mesh.h"

namespace tissue_contact {

/// Refuses a mesh with a crack: where the elements on both sides of a quadrangle split it along different diagonals, so that four faces of the
/// same four nodes lie on each other and none is shared (hexahedra that were all split in the same way, say), but for quadrangles that are bent
/// by more than a sixth of an edge. A hole as large as a tetrahedron of a mesh is none. Not found: nodes of one element that hang on a side or
/// edge of another.
/// @pre node indices in range. @throws std::invalid_argument naming `source` and the nodes; and as boundaryTriangles().
void checkConforming(const TetMesh& mesh, const std::string& source);

/// Parts of which no two share a node. @pre node indices in range.
std::size_t countParts(const TetMesh& mesh);
/// Parts of which no two share a face: more than those where some hang on others by edges or nodes alone, about which they turn freely.
/// @pre node indices in range.
std::size_t countPartsByFaces(const TetMesh& mesh);

}  // namespace tissue_contact
