/// @file
/// Room `tissue`: what is asked of any tetrahedral mesh: checks, volume, boundary surface.
#include "tissue_contact/tissue/tet_mesh.h"

#include <algorithm>
#include <array>
#include <sstream>
#include <stdexcept>

#include "mesh_checks.h"

namespace tissue_contact {
namespace {

// Relative to the cube of the longest edge (a regular tetrahedron has 0.118): below it the sign of the volume is
// rounding.
constexpr double kZeroVolume = 1e-12;

/// Volume over the cube of the longest edge: free of the mesh's unit, and of overflow.
double relativeVolume(const NodalVectors& x, const Tetrahedron& tet) {
  double longest = 0.0;
  for (std::size_t i = 0; i < tet.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) longest = std::max(longest, (x.col(tet[i]) - x.col(tet[j])).stableNorm());
  }
  const Vector3 b = (x.col(tet[1]) - x.col(tet[0])) / longest;
  const Vector3 c = (x.col(tet[2]) - x.col(tet[0])) / longest;
  const Vector3 d = (x.col(tet[3]) - x.col(tet[0])) / longest;
  return b.cross(c).dot(d) / 6.0;
}

void checkElement(const TetMesh& mesh, std::size_t index, const std::string& source) {
  const Tetrahedron& tet = mesh.tetrahedra[index];
  checkNodeIndices(tet, index, mesh.positions.cols(), "tetrahedron", source);
  const double volume = relativeVolume(mesh.positions, tet);
  if (volume > kZeroVolume) return;
  std::ostringstream message;
  message << indexed("tetrahedron", index) << " (nodes " << tet[0] << ", " << tet[1] << ", " << tet[2] << ", "
          << tet[3];
  // NaN (all four nodes in one place) counts as zero volume.
  if (volume < -kZeroVolume) {
    message << ") is inverted, of volume " << signedVolume(mesh.positions, tet)
            << " m^3; it must be positive: swap two of its nodes or repair the mesh";
  } else {
    message << ") has no volume (it is flat to 1e-12 of its longest edge cubed); remesh or remove it";
  }
  refuseMesh(source, message.str());
}

/// A face with its nodes sorted, so that both of its tetrahedra find the same key.
struct Face {
  std::array<int, 3> key;
  std::size_t number;  ///< 4 * tetrahedron + local face: the order of the result
};

/// Faces opposite to nodes 0 to 3, counter-clockwise seen from outside a tetrahedron of positive volume.
constexpr std::array<std::array<std::size_t, 3>, 4> kOutwardFaces = {{{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}}};

Triangle outwardFace(const std::vector<Tetrahedron>& tetrahedra, std::size_t number) {
  const Tetrahedron& tet = tetrahedra[number / 4];
  const auto& local = kOutwardFaces[number % 4];
  return {tet[local[0]], tet[local[1]], tet[local[2]]};
}

std::vector<Face> sortedFaces(const std::vector<Tetrahedron>& tetrahedra) {
  std::vector<Face> faces;
  faces.reserve(4 * tetrahedra.size());
  for (std::size_t number = 0; number < 4 * tetrahedra.size(); ++number) {
    Triangle key = outwardFace(tetrahedra, number);
    std::sort(key.begin(), key.end());
    faces.push_back({key, number});
  }
  std::sort(faces.begin(), faces.end(),
            [](const Face& a, const Face& b) { return a.key != b.key ? a.key < b.key : a.number < b.number; });
  return faces;
}

}  // namespace

double signedVolume(const NodalVectors& x, const Tetrahedron& tet) {
  const Vector3 a = x.col(tet[0]);
  const Vector3 b = x.col(tet[1]) - a;
  const Vector3 c = x.col(tet[2]) - a;
  const Vector3 d = x.col(tet[3]) - a;
  return b.cross(c).dot(d) / 6.0;
}

void checkTetMesh(const TetMesh& mesh, const std::string& source) {
  if (mesh.tetrahedra.empty()) refuseMesh(source, "the mesh has no tetrahedra; it must have at least one");
  checkFiniteNodes(mesh.positions, source);
  for (std::size_t i = 0; i < mesh.tetrahedra.size(); ++i) checkElement(mesh, i, source);
  checkDuplicates(mesh.tetrahedra, "tetrahedron", source);
  checkReferences(mesh.tetrahedra, mesh.positions.cols(), "tetrahedron",
                  "set `remove_unreferenced_nodes: true` for this mesh, or repair it", source);
}

std::vector<Triangle> boundaryTriangles(const std::vector<Tetrahedron>& tetrahedra) {
  const std::vector<Face> faces = sortedFaces(tetrahedra);
  std::vector<std::size_t> numbers;
  for (std::size_t i = 0, end = 0; i < faces.size(); i = end) {
    for (end = i + 1; end < faces.size() && faces[end].key == faces[i].key;) ++end;
    if (end - i > 2) {
      const auto& key = faces[i].key;
      throw std::invalid_argument(
          "the face of nodes " + std::to_string(key[0]) + ", " + std::to_string(key[1]) + ", " +
          std::to_string(key[2]) + " belongs to " + std::to_string(end - i) + " tetrahedra, among them " +
          std::to_string(faces[i].number / 4) + ", " + std::to_string(faces[i + 1].number / 4) + " and " +
          std::to_string(faces[i + 2].number / 4) + "; at most 2 may share it: repair the mesh");
    }
    if (end - i == 1) numbers.push_back(faces[i].number);
  }
  std::sort(numbers.begin(), numbers.end());
  std::vector<Triangle> triangles;
  triangles.reserve(numbers.size());
  for (const std::size_t number : numbers) triangles.push_back(outwardFace(tetrahedra, number));
  return triangles;
}

}  // namespace tissue_contact
