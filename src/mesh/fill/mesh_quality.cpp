#include "mesh/fill/mesh_quality.h"

#include <algorithm>
#include <array>
#include <cmath>

#include "mesh/face_table.h"

namespace tissue_contact {
namespace {

/// Cosine of the smallest angle between two faces.
double sharpestCosine(const NodalVectors& x, const Tetrahedron& tet) {
  std::array<Vector3, 4> outward;
  for (std::size_t i = 0; i < 4; ++i) {
    const Triangle face = outwardFace(tet, i);
    const Vector3 a = x.col(face[0]);
    outward[i] = (Vector3(x.col(face[1])) - a).cross(Vector3(x.col(face[2])) - a).normalized();
  }
  double sharpest = -1.0;
  for (std::size_t i = 0; i < 4; ++i) {
    for (std::size_t j = 0; j < i; ++j) sharpest = std::max(sharpest, -outward[i].dot(outward[j]));
  }
  return sharpest;
}

}  // namespace

MeshQuality qualityOf(const TetMesh& mesh) {
  constexpr double kDegrees = 57.29577951308232;
  MeshQuality quality;
  double sharpest = -1.0;
  for (const Tetrahedron& tet : mesh.tetrahedra) {
    quality.volume += signedVolume(mesh.positions, tet);
    sharpest = std::max(sharpest, sharpestCosine(mesh.positions, tet));
  }
  quality.smallest_angle = kDegrees * std::acos(std::clamp(sharpest, -1.0, 1.0));
  return quality;
}

}  // namespace tissue_contact
