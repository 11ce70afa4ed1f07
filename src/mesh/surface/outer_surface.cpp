#include "mesh/surface/outer_surface.h"

#include <algorithm>
#include <array>
#include <cstddef>
#include <vector>

#include "mesh/nodes.h"
#include "mesh/surface/triangle_geometry.h"

namespace tissue_contact {
namespace {

/// Whether a straight line comes upon a triangle otherwise than at its rim: there the inside may begin or end.
class Plate {
 public:
  /// @param tolerance what is nearer than this to the plane lies in it, and to the rim at the rim, m.
  Plate(const std::array<Vector3, 3>& corners, const Vector3& normal, double tolerance)
      : corners_(corners), normal_(normal), tolerance_(tolerance) {
    for (std::size_t k = 0; k < 3; ++k) inward_[k] = normal.cross(corners[(k + 1) % 3] - corners[k]).normalized();
  }

  double height(const Vector3& p) const { return normal_.dot(p - corners_[0]); }

  /// Of the part of a segment that lies in the plane, whether any is clear of the rim.
  bool isMetBy(const Vector3& from, const Vector3& to) const {
    double first = 0.0;
    double last = 1.0;
    const double start = height(from);
    const double end = height(to);
    clip(start + tolerance_, end + tolerance_, first, last);
    clip(tolerance_ - start, tolerance_ - end, first, last);
    for (std::size_t k = 0; k < 3 && first <= last; ++k) {
      clip(inward_[k].dot(from - corners_[k]) - tolerance_, inward_[k].dot(to - corners_[k]) - tolerance_, first, last);
    }
    return first <= last;
  }

  /// Whether a segment goes through, from well on one side to well on the other.
  bool isPiercedBy(const Vector3& from, const Vector3& to) const {
    const double start = height(from);
    const double end = height(to);
    if (!(std::min(start, end) < -tolerance_ && std::max(start, end) > tolerance_)) return false;
    const Vector3 p = from + start / (start - end) * (to - from);
    for (std::size_t k = 0; k < 3; ++k) {
      if (!(inward_[k].dot(p - corners_[k]) >= 0.0)) return false;
    }
    return true;
  }

 private:
  /// Leaves of a segment what has a value >= 0, which is linear along it.
  static void clip(double at_start, double at_end, double& first, double& last) {
    if (at_start < 0.0 && at_end < 0.0) {
      last = -1.0;
    } else if (at_start < 0.0) {
      first = std::max(first, at_start / (at_start - at_end));
    } else if (at_end < 0.0) {
      last = std::min(last, at_start / (at_start - at_end));
    }
  }

  const std::array<Vector3, 3>& corners_;
  Vector3 normal_;
  double tolerance_;
  std::array<Vector3, 3> inward_;  ///< per edge, in the plane
};

class OuterSurface {
 public:
  OuterSurface(const WindingTree& tree, double finest) : tree_(tree), finest_(finest) {}

  void add(const std::array<Vector3, 3>& corners) {
    const Vector3 normal = triangleNormal(corners[0], corners[1], corners[2]);
    if (normal.isZero(0.0)) return;
    if (!hasTime()) return keep(corners);
    const int outer = outerPoints(corners, normal);
    const std::array<double, 3> edges = {(corners[1] - corners[0]).norm(), (corners[2] - corners[1]).norm(),
                                         (corners[0] - corners[2]).norm()};
    const auto at = static_cast<std::size_t>(std::max_element(edges.begin(), edges.end()) - edges.begin());
    const double longest = edges[at];
    // Four points tell little of a triangle that is long beside what it may pass through.
    constexpr double kTold = 16.0;
    const bool is_told = (outer == 0 || outer == 4) && longest < kTold * finest_;
    if (longest < finest_ || (is_told && !isMet(corners, normal))) {
      if (outer > 0) keep(corners);
      return;
    }
    if (is_told) looks_left_ -= std::min(looks_left_, kSplit);
    // In two, and not into four alike: of a shaft's long and narrow triangles those would be as narrow, and as near to its axis as
    // a thousand others.
    const Vector3& a = corners[at];
    const Vector3& b = corners[(at + 1) % 3];
    const Vector3& c = corners[(at + 2) % 3];
    const Vector3 middle = 0.5 * (a + b);
    add({a, middle, c});
    add({middle, b, c});
  }

  /// Whether the points of another triangle may be looked at.
  bool hasTime() const { return point_looks_ < kMostPointLooks; }

  void keep(const std::array<Vector3, 3>& corners) { points_.insert(points_.end(), corners.begin(), corners.end()); }

  TriangleMesh mesh() const { return separateTriangles(points_); }

 private:
  /// Of the middle and three points near the corners: how many do not have the inside on both sides.
  int outerPoints(const std::array<Vector3, 3>& corners, const Vector3& normal) {
    const Vector3 middle = (corners[0] + corners[1] + corners[2]) / 3.0;
    const auto isOuter = [&](const Vector3& p) {
      const Vector3 aside = kAside * finest_ * normal;
      return !(tree_.isInside(p + aside, point_looks_) && tree_.isInside(p - aside, point_looks_));
    };
    int count = isOuter(middle) ? 1 : 0;
    for (const Vector3& corner : corners) count += isOuter(0.9 * corner + 0.1 * middle) ? 1 : 0;
    return count;
  }

  /// Whether the mesh comes upon the inside of a triangle anywhere: what four points tell need not hold beyond. Once a mesh that passes
  /// through itself all over has taken some seconds, the points are believed.
  bool isMet(const std::array<Vector3, 3>& corners, const Vector3& normal) {
    const Plate plate(corners, normal, kAside * finest_);
    Eigen::AlignedBox3d box;
    for (const Vector3& corner : corners) box.extend(corner);
    waiting_.assign(1, 0);
    while (!waiting_.empty() && looks_left_ > 0) {
      --looks_left_;
      const TriangleTree::Node& node = tree_.triangles().nodes()[waiting_.back()];
      waiting_.pop_back();
      if (!node.box.intersects(box)) continue;
      if (node.triangle < 0) {
        waiting_.push_back(node.children + 1);
        waiting_.push_back(node.children);
      } else if (meets(tree_.triangles().corners(node.triangle), plate, corners)) {
        return true;
      }
    }
    return false;
  }

  /// A triangle of the mesh and a piece of another, or of the same.
  bool meets(const Vector3* other, const Plate& plate, const std::array<Vector3, 3>& corners) const {
    const std::array<Vector3, 3> others = {other[0], other[1], other[2]};
    const Vector3 normal = triangleNormal(others[0], others[1], others[2]);
    if (normal.isZero(0.0)) return false;
    const Plate other_plate(others, normal, kAside * finest_);
    for (std::size_t k = 0; k < 3; ++k) {
      if (plate.isMetBy(others[k], others[(k + 1) % 3])) return true;
      if (other_plate.isPiercedBy(corners[k], corners[(k + 1) % 3])) return true;
    }
    return false;
  }

  static constexpr double kAside = 0.02;  // of the finest
  static constexpr int kSplit =
      500;  // looks that a cut costs as much as: eight points, twice each, in the winding tree

  static constexpr std::size_t kMostPointLooks = 1000000000;  // half a minute of them

  const WindingTree& tree_;
  double finest_;
  std::size_t point_looks_ = 0;  ///< at boxes and triangles, for the points of pieces
  std::vector<Vector3> points_;
  std::vector<int> waiting_;
  int looks_left_ = 50000000;  ///< at boxes and triangles
};

}  // namespace

TriangleMesh outerSurface(const TriangleMesh& mesh, const WindingTree& tree, double finest,
                          const std::function<void(double share)>& progress, std::size_t* left) {
  OuterSurface surface(tree, finest);
  const double count = static_cast<double>(mesh.triangles.size());
  std::size_t done = 0;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) {
    const Triangle& t = mesh.triangles[i];
    if (progress) progress(static_cast<double>(i) / count);
    surface.add({mesh.vertices.col(t[0]), mesh.vertices.col(t[1]), mesh.vertices.col(t[2])});
    if (surface.hasTime()) ++done;
  }
  if (left != nullptr) *left = mesh.triangles.size() - done;
  return surface.mesh();
}

}  // namespace tissue_contact
