/// @file
/// Room `mesh`, private: how good the shapes of tetrahedra are.
#pragma once

#include <string>

#include "tissue_contact/mesh/tet_mesh.h"

namespace tissue_contact {

struct MeshQuality {
  double volume = 0.0;  ///< m^3
  /// Between two faces of a tetrahedron, degrees: 70.5 in a regular one; elements below some five are near flat and slow solvers.
  double smallest_angle = 180.0;
};

/// @param mesh that checkTetMesh() passes.
MeshQuality qualityOf(const TetMesh& mesh);

/// How many elements are so flat that they turn inside out as soon as they are pressed, and where the flattest is; empty where none is.
std::string flatElementsText(const TetMesh& mesh);

}  // namespace tissue_contact
