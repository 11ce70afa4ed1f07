#include "mesh/orientation.h"

#include <utility>
#include <vector>

#include "mesh/face_table.h"

namespace tissue_contact {
namespace {

/// Whether its tetrahedron sees the face in the order of its ascending nodes, from outside.
bool isAscending(const FaceUse& face, const std::vector<Tetrahedron>& tetrahedra) {
  const Triangle outward = outwardFace(tetrahedra[face.tetrahedron], face.opposite);
  const auto& [a, b, c] = face.nodes;
  return outward == Triangle{a, b, c} || outward == Triangle{b, c, a} || outward == Triangle{c, a, b};
}

/// Of positive tetrahedra: whether those that share a face lie on both its sides.
bool fitTogether(const std::vector<Tetrahedron>& tetrahedra) {
  const std::vector<FaceUse> faces = sortedFaces(tetrahedra);
  for (std::size_t i = 1; i < faces.size(); ++i) {
    const bool is_shared = faces[i].nodes == faces[i - 1].nodes;
    if (is_shared && isAscending(faces[i], tetrahedra) == isAscending(faces[i - 1], tetrahedra)) return false;
  }
  return true;
}

}  // namespace

std::size_t turnTetrahedra(TetMesh& mesh) {
  std::vector<Tetrahedron> turned = mesh.tetrahedra;
  std::size_t count = 0;
  for (Tetrahedron& tet : turned) {
    if (!(signedVolume(mesh.positions, tet) < 0.0)) continue;
    std::swap(tet[2], tet[3]);
    ++count;
  }
  if (count == 0 || !fitTogether(turned)) return 0;
  mesh.tetrahedra = std::move(turned);
  return count;
}

}  // namespace tissue_contact
