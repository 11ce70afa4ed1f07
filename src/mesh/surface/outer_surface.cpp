#include "mesh/surface/outer_surface.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

#include "mesh/nodes.h"
#include "mesh/surface/triangle_geometry.h"

namespace tissue_contact {
namespace {

class OuterSurface {
 public:
  OuterSurface(const WindingTree& tree, double finest) : tree_(tree), finest_(finest) {}

  void add(const std::array<Vector3, 3>& corners) {
    const Vector3 normal = triangleNormal(corners[0], corners[1], corners[2]);
    if (normal.isZero(0.0)) return;
    const int outer = outerPoints(corners, normal);
    const std::array<double, 3> edges = {(corners[1] - corners[0]).norm(), (corners[2] - corners[1]).norm(),
                                         (corners[0] - corners[2]).norm()};
    const auto at = static_cast<std::size_t>(std::max_element(edges.begin(), edges.end()) - edges.begin());
    const double longest = edges[at];
    // Four points tell little of a triangle that is long beside what it may pass through.
    constexpr double kTold = 16.0;
    if (longest < finest_ || ((outer == 0 || outer == 4) && longest < kTold * finest_)) {
      if (outer == 0) return;
      for (const Vector3& corner : corners) points_.push_back(corner);
      return;
    }
    // In two, and not into four alike: of a shaft's long and narrow triangles those would be as narrow, and as near to its axis as
    // a thousand others.
    const Vector3& a = corners[at];
    const Vector3& b = corners[(at + 1) % 3];
    const Vector3& c = corners[(at + 2) % 3];
    const Vector3 middle = 0.5 * (a + b);
    add({a, middle, c});
    add({middle, b, c});
  }

  TriangleMesh mesh() const { return separateTriangles(points_); }

 private:
  /// Of the middle and three points near the corners: how many do not have the inside on both sides.
  int outerPoints(const std::array<Vector3, 3>& corners, const Vector3& normal) const {
    const Vector3 middle = (corners[0] + corners[1] + corners[2]) / 3.0;
    const auto isOuter = [&](const Vector3& p) {
      const Vector3 aside = 0.02 * finest_ * normal;
      return !(tree_.isInside(p + aside) && tree_.isInside(p - aside));
    };
    int count = isOuter(middle) ? 1 : 0;
    for (const Vector3& corner : corners) count += isOuter(0.9 * corner + 0.1 * middle) ? 1 : 0;
    return count;
  }

  const WindingTree& tree_;
  double finest_;
  std::vector<Vector3> points_;
};

}  // namespace

TriangleMesh outerSurface(const TriangleMesh& mesh, const WindingTree& tree, double finest) {
  OuterSurface surface(tree, finest);
  for (const Triangle& t : mesh.triangles) {
    surface.add({mesh.vertices.col(t[0]), mesh.vertices.col(t[1]), mesh.vertices.col(t[2])});
  }
  return surface.mesh();
}

}  // namespace tissue_contact
