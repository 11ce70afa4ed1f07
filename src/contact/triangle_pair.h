/// @file
/// Room `contact`: distance between a tissue triangle and the triangles of a mesh.
#pragma once

#include <array>

#include "contact/soft_minimum.h"
#include "contact/triangle_geometry.h"

namespace tissue_contact {

/// Collects where on one triangle others come nearest: of two triangles apart, a vertex and a face or two edges are
/// nearest, so trying all pairs is exact; where they intersect, the ends of the line of intersection lie on an edge and
/// a face.
class TrianglePair {
 public:
  /// @param tolerance m: points that much farther than the nearest count as equally near (SoftMinimum)
  TrianglePair(const TrianglePoints& triangle, double tolerance) : triangle_(triangle), nearest_(tolerance) {}

  /// @param reach m: others farther away need not be looked at
  void offer(const std::array<Vector3, 3>& other, double reach);

  /// m; 0 when one of the others intersects, infinite when none was offered.
  double distance() const { return crossings_ > 0 ? 0.0 : nearest_.lowest(); }

  /// Barycentric: the nearest point, or the mean of the ends of all lines of intersection.
  Vector3 weights() const { return crossings_ > 0 ? Vector3(crossing_sum_ / crossings_) : nearest_.weights(); }

 private:
  void offerEdges(const std::array<Vector3, 3>& other);
  void offerCrossings(const std::array<Vector3, 3>& other);
  void addCrossing(const Vector3& p);

  const TrianglePoints& triangle_;
  SoftMinimum nearest_;
  Vector3 crossing_sum_ = Vector3::Zero();
  int crossings_ = 0;
};

}  // namespace tissue_contact
