#include "mesh/conformity.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "core/disjoint_sets.h"
#include "mesh/edge_table.h"
#include "mesh/face_table.h"
#include "mesh/mesh_checks.h"

namespace tissue_contact {
namespace {

// Of the cube of the longest edge: a regular tetrahedron has 0.118, the gap between two splits of a quadrangle of which one corner is off its
// plane by a sixth of an edge .01.
constexpr double kThinGap = 0.01;

Triangle ascending(Triangle nodes) {
  std::sort(nodes.begin(), nodes.end());
  return nodes;
}

int nodeOpposite(const Triangle& triangle, const std::array<int, 2>& edge) {
  return *std::find_if(triangle.begin(), triangle.end(), [&](int node) { return node != edge[0] && node != edge[1]; });
}

}  // namespace

void checkConforming(const TetMesh& mesh, const std::string& source) {
  const std::vector<OuterFace> outer = outerFaces(mesh.tetrahedra);
  std::vector<Triangle> triangles;
  std::vector<Triangle> sorted;
  for (const OuterFace& face : outer) {
    triangles.push_back(outwardFace(mesh.tetrahedra[face.tetrahedron], face.opposite));
    sorted.push_back(ascending(triangles.back()));
  }
  std::sort(sorted.begin(), sorted.end());
  const auto isOuter = [&](int a, int b, int c) {
    return std::binary_search(sorted.begin(), sorted.end(), ascending({a, b, c}));
  };
  const EdgeTable table(triangles);
  for (const EdgeTable::Edge& edge : table) {
    const EdgeTable::Uses uses = table.usesOf(edge);
    if (uses.size() != 2) continue;
    const auto& [a, b] = edge.nodes;
    const auto one = static_cast<std::size_t>(uses[0].triangle);
    const auto two = static_cast<std::size_t>(uses[1].triangle);
    const int c = nodeOpposite(triangles[one], edge.nodes);
    const int d = nodeOpposite(triangles[two], edge.nodes);
    if (outer[one].tetrahedron == outer[two].tetrahedron || c == d || !isOuter(a, c, d) || !isOuter(b, c, d)) continue;
    if (!(std::abs(relativeVolume(mesh.positions, {a, b, c, d})) < kThinGap)) continue;
    refuseMesh(
        source,
        "the elements on both sides of the quadrangle of nodes " + std::to_string(a) + ", " + std::to_string(c) + ", " +
            std::to_string(b) + ", " + std::to_string(d) +
            " split it along different diagonals, so that they do not hang together there (or an element is missing "
            "between them); where hexahedra were split into tetrahedra, give the hexahedra, or split neighbours "
            "mirrored");
  }
}

std::size_t countParts(const TetMesh& mesh) {
  DisjointSets sets(static_cast<std::size_t>(mesh.positions.cols()));
  std::vector<bool> used(static_cast<std::size_t>(mesh.positions.cols()), false);
  for (const Tetrahedron& tet : mesh.tetrahedra) {
    for (const int node : tet) {
      sets.join(tet[0], node);
      used[static_cast<std::size_t>(node)] = true;
    }
  }
  std::size_t parts = 0;
  for (int i = 0; i < static_cast<int>(used.size()); ++i) {
    if (used[static_cast<std::size_t>(i)] && sets.first(i) == i) ++parts;
  }
  return parts;
}

std::size_t countPartsByFaces(const TetMesh& mesh) {
  DisjointSets sets(mesh.tetrahedra.size());
  const std::vector<FaceUse> faces = sortedFaces(mesh.tetrahedra);
  for (std::size_t i = 1; i < faces.size(); ++i) {
    if (faces[i].nodes != faces[i - 1].nodes) continue;
    sets.join(static_cast<int>(faces[i - 1].tetrahedron), static_cast<int>(faces[i].tetrahedron));
  }
  std::size_t parts = 0;
  for (int i = 0; i < static_cast<int>(mesh.tetrahedra.size()); ++i) parts += sets.first(i) == i ? 1 : 0;
  return parts;
}

}  // namespace tissue_contact
