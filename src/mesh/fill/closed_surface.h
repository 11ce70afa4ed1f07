/// @file
/// Room `mesh`, private: from the triangles of a scanned or segmented organ to a closed surface that can be filled.
#pragma once

#include <string>
#include <vector>

#include "tissue_contact/core/types.h"
#include "tissue_contact/mesh/triangle_mesh.h"

namespace tissue_contact {

struct ClosedSurface {
  TriangleMesh mesh;               ///< each part closed, m
  double volume = 0.0;             ///< m^3, without cavities
  std::vector<std::string> notes;  ///< what was changed, a sentence each
};

/// Drops duplicate triangles and loose parts smaller than two cells, closes holes up to three cells wide, turns triangles that
/// face the wrong way.
/// @param mesh vertices shared by triangles (mergeVertices()), m.
/// @param cell_m edge of the cells that are to fill it.
/// @param source begins messages: "mesh file 'liver.stl'".
/// @throws std::invalid_argument naming the source and a place, m, where it cannot be closed: edges of more than two
///   triangles, larger holes, several bodies.
ClosedSurface closeSurface(TriangleMesh mesh, double cell_m, const std::string& source);

/// Signed volume that a closed surface encloses, positive where its triangles face outward, m^3.
double volumeInside(const TriangleMesh& mesh);

}  // namespace tissue_contact
