/// @file
/// Room `mesh`, private: which way round the nodes of tetrahedra are numbered. Many programs do not care, FEniCS by its own convention.
#pragma once

#include <cstddef>
#include <string>

#include "tissue_contact/mesh/tet_mesh.h"

namespace tissue_contact {

/// Swaps two nodes of each tetrahedron of negative volume. What else is wrong (flat, twice, a face of three) stays for checkTetMesh() and
/// boundaryTriangles() to refuse.
/// @pre node indices in range. @return how many were turned.
/// @throws std::invalid_argument naming `source` and the two where tetrahedra then lie on the same side of the face they share: the mesh is
///   folded, however it is numbered.
std::size_t turnTetrahedra(TetMesh& mesh, const std::string& source);

}  // namespace tissue_contact
