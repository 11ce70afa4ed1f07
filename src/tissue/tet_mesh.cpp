/// @file
/// Room `tissue`: what is asked of any tetrahedral mesh: checks, volume, boundary surface, fixed nodes.
#include "tissue_contact/tissue/tet_mesh.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <sstream>
#include <stdexcept>
#include <variant>

namespace tissue_contact {
namespace {

// Relative to the cube of the longest edge (a regular tetrahedron has 0.118): below it the sign of the volume is
// rounding.
constexpr double kZeroVolume = 1e-12;

[[noreturn]] void refuse(const std::string& source, const std::string& message) {
  throw std::invalid_argument(source + ": " + message);
}

std::string label(const char* thing, std::size_t index) { return std::string(thing) + " " + std::to_string(index); }

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

void checkNodes(const NodalVectors& x, const std::string& source) {
  for (Eigen::Index i = 0; i < x.cols(); ++i) {
    if (x.col(i).allFinite()) continue;
    std::ostringstream message;
    message << "node " << i << " is at (" << x.col(i).transpose() << ") m; coordinates must be finite";
    refuse(source, message.str());
  }
}

void checkElement(const TetMesh& mesh, std::size_t index, const std::string& source) {
  const Tetrahedron& tet = mesh.tetrahedra[index];
  for (const int node : tet) {
    if (node >= 0 && node < mesh.positions.cols()) continue;
    refuse(source, label("tetrahedron", index) + " refers to node " + std::to_string(node) + ", but there are " +
                       std::to_string(mesh.positions.cols()) + " nodes (numbered from 0)");
  }
  const double volume = relativeVolume(mesh.positions, tet);
  if (volume > kZeroVolume) return;
  std::ostringstream message;
  message << label("tetrahedron", index) << " (nodes " << tet[0] << ", " << tet[1] << ", " << tet[2] << ", " << tet[3];
  // NaN (all four nodes in one place) counts as zero volume.
  if (volume < -kZeroVolume) {
    message << ") is inverted, of volume " << signedVolume(mesh.positions, tet)
            << " m^3; it must be positive: swap two of its nodes or repair the mesh";
  } else {
    message << ") has no volume (it is flat to 1e-12 of its longest edge cubed); remesh or remove it";
  }
  refuse(source, message.str());
}

void checkDuplicates(const std::vector<Tetrahedron>& tetrahedra, const std::string& source) {
  std::vector<std::pair<Tetrahedron, std::size_t>> sorted;
  sorted.reserve(tetrahedra.size());
  for (std::size_t i = 0; i < tetrahedra.size(); ++i) {
    Tetrahedron key = tetrahedra[i];
    std::sort(key.begin(), key.end());
    sorted.emplace_back(key, i);
  }
  std::sort(sorted.begin(), sorted.end());
  const auto same =
      std::adjacent_find(sorted.begin(), sorted.end(), [](const auto& a, const auto& b) { return a.first == b.first; });
  if (same == sorted.end()) return;
  refuse(source, label("tetrahedron", (same + 1)->second) + " has the same four nodes as " +
                     label("tetrahedron", same->second) + "; remove one of the two");
}

void checkReferences(const TetMesh& mesh, const std::string& source) {
  std::vector<bool> used(static_cast<std::size_t>(mesh.positions.cols()), false);
  for (const Tetrahedron& tet : mesh.tetrahedra) {
    for (const int node : tet) used[static_cast<std::size_t>(node)] = true;
  }
  const auto unused = std::count(used.begin(), used.end(), false);
  if (unused == 0) return;
  const auto first = std::find(used.begin(), used.end(), false) - used.begin();
  refuse(source, "node " + std::to_string(first) + " belongs to no tetrahedron (" + std::to_string(unused) +
                     " such in all); set `remove_unreferenced_nodes: true` for this mesh, or repair it");
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

/// A distance (m) within which a node counts as on the boundary of a region: the rounding of coordinates such as 0.1
/// * 3.
double roundingDistance(const NodalVectors& x) {
  return x.cols() == 0 ? 0.0 : 1e-9 * (x.rowwise().maxCoeff() - x.rowwise().minCoeff()).norm();
}

bool holds(const BoxRegion& box, const Vector3& x, double rounding) {
  return ((x - box.min_m).array() >= -rounding).all() && ((box.max_m - x).array() >= -rounding).all();
}
bool holds(const PlaneRegion& plane, const Vector3& x, double rounding) {
  const double norm = plane.normal.norm();  // without a direction it holds nothing
  return norm > 0.0 && plane.normal.dot(x - plane.point_m) <= rounding * norm;
}
bool holds(const SphereRegion& sphere, const Vector3& x, double rounding) {
  return (x - sphere.center_m).norm() <= sphere.radius_m + rounding;
}

void describe(const BoxRegion& box, std::ostream& out) {
  out << "box from (" << box.min_m.transpose() << ") to (" << box.max_m.transpose() << ") m";
}
void describe(const PlaneRegion& plane, std::ostream& out) {
  out << "plane through (" << plane.point_m.transpose() << ") m, against its normal (" << plane.normal.transpose()
      << ")";
}
void describe(const SphereRegion& sphere, std::ostream& out) {
  out << "sphere around (" << sphere.center_m.transpose() << ") m of radius " << sphere.radius_m << " m";
}

[[noreturn]] void refuseRegion(const NodalVectors& x, const Region& region, std::size_t index,
                               const std::string& source) {
  std::ostringstream message;
  message << "fixed region " << index << " (";
  std::visit([&](const auto& shape) { describe(shape, message); }, region);
  message << ") holds no node; ";
  if (x.cols() > 0) {
    message << "the mesh lies within (" << x.rowwise().minCoeff().transpose() << ") to ("
            << x.rowwise().maxCoeff().transpose() << ") m of the tissue frame: move or enlarge the region";
  } else {
    message << "the mesh has no nodes";
  }
  refuse(source, message.str());
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
  if (mesh.tetrahedra.empty()) refuse(source, "the mesh has no tetrahedra; it must have at least one");
  checkNodes(mesh.positions, source);
  for (std::size_t i = 0; i < mesh.tetrahedra.size(); ++i) checkElement(mesh, i, source);
  checkDuplicates(mesh.tetrahedra, source);
  checkReferences(mesh, source);
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

std::vector<bool> fixedNodes(const NodalVectors& positions, const std::vector<Region>& regions,
                             const std::string& source) {
  std::vector<bool> fixed(static_cast<std::size_t>(positions.cols()), false);
  const double rounding = roundingDistance(positions);
  for (std::size_t r = 0; r < regions.size(); ++r) {
    bool any = false;
    for (Eigen::Index i = 0; i < positions.cols(); ++i) {
      const Vector3 x = positions.col(i);
      if (!std::visit([&](const auto& shape) { return holds(shape, x, rounding); }, regions[r])) continue;
      fixed[static_cast<std::size_t>(i)] = any = true;
    }
    if (!any) refuseRegion(positions, regions[r], r, source);
  }
  return fixed;
}

}  // namespace tissue_contact
