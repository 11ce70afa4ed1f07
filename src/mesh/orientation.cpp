#include "mesh/orientation.h"

#include <algorithm>
#include <sstream>
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

/// @param turned per tetrahedron.
void requireNoFold(const TetMesh& mesh, const std::vector<bool>& turned, const std::string& source) {
  const std::vector<FaceUse> faces = sortedFaces(mesh.tetrahedra);
  for (std::size_t i = 0, end = 0; i < faces.size(); i = end) {
    for (end = i + 1; end < faces.size() && faces[end].nodes == faces[i].nodes;) ++end;
    if (end - i != 2 || !isFold(faces[i], faces[i + 1], mesh)) continue;
    const auto& [a, b, c] = faces[i].nodes;
    const std::size_t one = faces[i].tetrahedron;
    const std::size_t two = faces[i + 1].tetrahedron;
    std::ostringstream message;
    message << "tetrahedra " << one << " and " << two << " lie on the same side of the face they share (nodes " << a
            << ", " << b << ", " << c << "): one of them is inverted";
    if (turned[one] != turned[two])
      message << " (as they are numbered, tetrahedron " << (turned[one] ? one : two) << ")";
    refuseMesh(source, message.str() + "; the mesh is folded there: repair it");
  }
}

}  // namespace

std::size_t turnTetrahedra(TetMesh& mesh, const std::string& source) {
  std::vector<bool> turned(mesh.tetrahedra.size(), false);
  for (std::size_t i = 0; i < turned.size(); ++i) {
    Tetrahedron& tet = mesh.tetrahedra[i];
    turned[i] = signedVolume(mesh.positions, tet) < 0.0;
    if (turned[i]) std::swap(tet[2], tet[3]);
  }
  requireNoFold(mesh, turned, source);
  return static_cast<std::size_t>(std::count(turned.begin(), turned.end(), true));
}

}  // namespace tissue_contact
