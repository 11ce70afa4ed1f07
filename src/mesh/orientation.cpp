#include "mesh/orientation.h"

#include <cmath>
#include <utility>
#include <vector>

#include "mesh/face_table.h"
#include "mesh/mesh_checks.h"

namespace tissue_contact {
namespace {

/// Whether its tetrahedron sees the face in the order of its ascending nodes, from outside.
bool isAscending(const FaceUse& face, const std::vector<Tetrahedron>& tetrahedra) {
  const Triangle outward = outwardFace(tetrahedra[face.tetrahedron], face.opposite);
  const auto& [a, b, c] = face.nodes;
  return outward == Triangle{a, b, c} || outward == Triangle{b, c, a} || outward == Triangle{c, a, b};
}

/// Of positive tetrahedra that alone share a face: they lie on the same side of it, and which it is is no rounding.
bool isFold(const FaceUse& one, const FaceUse& two, const TetMesh& mesh) {
  if (isAscending(one, mesh.tetrahedra) != isAscending(two, mesh.tetrahedra)) return false;
  const Tetrahedron& a = mesh.tetrahedra[one.tetrahedron];
  const Tetrahedron& b = mesh.tetrahedra[two.tetrahedron];
  if (a[one.opposite] == b[two.opposite]) return false;  // the same tetrahedron twice
  return relativeVolume(mesh.positions, a) > kZeroVolume && relativeVolume(mesh.positions, b) > kZeroVolume;
}

void requireNoFold(const TetMesh& mesh, const std::string& source) {
  const std::vector<FaceUse> faces = sortedFaces(mesh.tetrahedra);
  for (std::size_t i = 0, end = 0; i < faces.size(); i = end) {
    for (end = i + 1; end < faces.size() && faces[end].nodes == faces[i].nodes;) ++end;
    if (end - i != 2 || !isFold(faces[i], faces[i + 1], mesh)) continue;
    const auto& [a, b, c] = faces[i].nodes;
    refuseMesh(source, "tetrahedra " + std::to_string(faces[i].tetrahedron) + " and " +
                           std::to_string(faces[i + 1].tetrahedron) +
                           " lie on the same side of the face they share (nodes " + std::to_string(a) + ", " +
                           std::to_string(b) + ", " + std::to_string(c) +
                           "): one of them is inverted; the mesh is folded there: repair it");
  }
}

}  // namespace

std::size_t turnTetrahedra(TetMesh& mesh, const std::string& source) {
  std::size_t count = 0;
  for (Tetrahedron& tet : mesh.tetrahedra) {
    if (!(signedVolume(mesh.positions, tet) < 0.0)) continue;
    std::swap(tet[2], tet[3]);
    ++count;
  }
  requireNoFold(mesh, source);
  return count;
}

}  // namespace tissue_contact
