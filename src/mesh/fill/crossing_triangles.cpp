#include "mesh/fill/crossing_triangles.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <sstream>
#include <vector>

#include "mesh/surface/triangle_tree.h"

namespace tissue_contact {
namespace {

/// Where the segment passes through the inside of the triangle of corners c (Moeller and Trumbore 1997).
std::optional<Vector3> crossing(const Vector3& from, const Vector3& to, const Vector3* c) {
  const Vector3 way = to - from;
  const Vector3 u = c[1] - c[0];
  const Vector3 v = c[2] - c[0];
  const Vector3 p = way.cross(v);
  const double determinant = u.dot(p);
  // Parallel but for round-off, or without area. In one plane, as of a tube's strips, where the rest would be noise.
  constexpr double kParallel = 1e-9;
  if (std::abs(determinant) <= kParallel * way.norm() * u.norm() * v.norm()) return std::nullopt;
  const Vector3 s = (from - c[0]) / determinant;
  const double a = s.dot(p);
  const Vector3 q = s.cross(u);
  const double b = way.dot(q);
  const double t = v.dot(q);
  if (a < 0.0 || b < 0.0 || a + b > 1.0 || t < 0.0 || t > 1.0) return std::nullopt;
  return Vector3(from + t * way);
}

std::optional<Vector3> crossing(const Vector3* a, const Vector3* b) {
  for (int k = 0; k < 3; ++k) {
    if (auto place = crossing(a[k], a[(k + 1) % 3], b)) return place;
    if (auto place = crossing(b[k], b[(k + 1) % 3], a)) return place;
  }
  return std::nullopt;
}

bool shareVertex(const Triangle& a, const Triangle& b) {
  return std::any_of(a.begin(), a.end(), [&](int v) { return std::find(b.begin(), b.end(), v) != b.end(); });
}

}  // namespace

Crossings findCrossings(const TriangleMesh& mesh) {
  const TriangleTree tree(mesh.vertices, mesh.triangles);
  Crossings found;
  std::vector<int> near;
  // Slivers that lie in each other's boxes and do not cross: some ten seconds. What is beyond, whatever fills the surface meets.
  constexpr std::size_t kMostLookedAt = 200000000;
  std::size_t looked_at = 0;
  for (int t = 0; t < static_cast<int>(mesh.triangles.size()); ++t) {
    Eigen::AlignedBox3d box;
    for (int k = 0; k < 3; ++k) box.extend(tree.corners(t)[k]);
    tree.overlapping(box, near);
    looked_at += near.size();
    if (looked_at > kMostLookedAt) return found;
    for (const int other : near) {
      if (other <= t || shareVertex(mesh.triangles[t], mesh.triangles[other])) continue;
      const auto place = crossing(tree.corners(t), tree.corners(other));
      if (place && found.count++ == 0) found.place = *place;
      if (found.count > Crossings::kMost) return found;
    }
  }
  return found;
}

std::string crossingText(const Crossings& crossings) {
  std::ostringstream text;
  text.precision(3);
  text << "it passes through itself; " << (crossings.count > Crossings::kMost ? "more than " : "")
       << std::min(crossings.count, Crossings::kMost) << (crossings.count == 1 ? " pair" : " pairs")
       << " of triangles cross, the first at (" << crossings.place.transpose()
       << ") m; repair it there (Blender: 3D Print Toolbox; MeshLab: Remove Self Intersecting Faces, then Close Holes)";
  return text.str();
}

}  // namespace tissue_contact
