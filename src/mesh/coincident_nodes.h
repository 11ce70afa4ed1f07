/// @file
/// Room `mesh`, private: nodes of a volume mesh that lie in one place, so that the elements around it do not hang together there: what is
/// written element by element, parts that were meshed one by one, a cut.
#pragma once

#include <cstddef>
#include <vector>

#include "tissue_contact/core/types.h"
#include "tissue_contact/mesh/tet_mesh.h"
#include "tissue_contact/mesh/triangle_mesh.h"

namespace tissue_contact {

/// For each node the first used one that lies where it does; for a node that is not used itself. In one place: within kMergeDistance of the
/// diagonal of the box around those used, or, as far as that is a thousandth of the shortest edge, of what single precision resolves at their
/// distance from the origin (scanners put an organ metres away from it).
/// @param shortest_edge of the elements: one that is all but flat keeps the distance small, and findNearNodes() tells what stays apart.
/// @pre `used` has an entry for each node.
std::vector<int> firstInPlace(const std::vector<Vector3>& nodes, const std::vector<bool>& used, double shortest_edge);

/// Nodes of the surface that lie beside others, nearer than a hundredth of the edges at both and of the median edge: a gap that nobody sees, where
/// a mesh was to be one.
struct NearNodes {
  std::size_t count = 0;
  int one = -1, other = -1;  ///< the first two
};
NearNodes findNearNodes(const TetMesh& mesh);
/// Nodes of a shell's border. @pre triangles of three different nodes each.
NearNodes findNearNodes(const TriangleMesh& mesh);

}  // namespace tissue_contact
