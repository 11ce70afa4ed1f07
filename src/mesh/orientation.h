/// @file
/// Room `mesh`, private: which way round the nodes of tetrahedra are numbered. Many programs do not care, FEniCS by its own convention.
#pragma once

#include <cstddef>

#include "tissue_contact/mesh/tet_mesh.h"

namespace tissue_contact {

/// Swaps two nodes of each tetrahedron of negative volume, where that is all that is wrong: where then no two tetrahedra lie on the same
/// side of the face they share. Else the mesh is folded, and stays as it is for checkTetMesh() to refuse.
/// @pre node indices in range. @return how many were turned.
std::size_t turnTetrahedra(TetMesh& mesh);

}  // namespace tissue_contact
