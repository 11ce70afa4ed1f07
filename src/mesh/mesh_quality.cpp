#include "mesh/mesh_quality.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <sstream>

#include "mesh/face_table.h"

namespace tissue_contact {
namespace {

constexpr double kDegrees = 57.29577951308232;

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
  MeshQuality quality;
  double sharpest = -1.0;
  for (const Tetrahedron& tet : mesh.tetrahedra) {
    quality.volume += signedVolume(mesh.positions, tet);
    sharpest = std::max(sharpest, sharpestCosine(mesh.positions, tet));
  }
  quality.smallest_angle = kDegrees * std::acos(std::clamp(sharpest, -1.0, 1.0));
  return quality;
}

std::string flatElementsText(const TetMesh& mesh) {
  constexpr double kFlat = 1.0;  // degrees
  std::size_t count = 0;
  double sharpest = std::cos(kFlat / kDegrees);
  const Tetrahedron* flattest = nullptr;
  for (const Tetrahedron& tet : mesh.tetrahedra) {
    const double cosine = sharpestCosine(mesh.positions, tet);
    if (!(cosine > std::cos(kFlat / kDegrees))) continue;
    ++count;
    if (!(cosine > sharpest) && flattest != nullptr) continue;
    sharpest = cosine;
    flattest = &tet;
  }
  if (flattest == nullptr) return {};
  Vector3 middle = Vector3::Zero();
  for (const int corner : *flattest) middle += 0.25 * mesh.positions.col(corner);
  std::ostringstream text;
  text.precision(2);
  text << "warning: " << count << " of " << mesh.tetrahedra.size() << " elements are flat, with faces at less than "
       << kFlat << " degree to each other, the flattest at " << kDegrees * std::acos(std::min(sharpest, 1.0));
  text.precision(3);
  text << ", at (" << middle.x() << ", " << middle.y() << ", " << middle.z()
       << ") m: pressed there they turn inside out, and forces mean nothing; mesh it anew, with other cells or a "
          "surface without details much smaller than they";
  return text.str();
}

}  // namespace tissue_contact
