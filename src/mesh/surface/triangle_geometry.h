/// @file
/// Room `mesh`: points on triangles and segments.
#pragma once

#include <array>

#include "tissue_contact/core/types.h"

namespace tissue_contact {

/// A barycentric weight below this is zero: the point lies on the opposite edge. Well above the round-off of a
/// projection (1e-15) and well below anything a mesh resolves.
constexpr double kSnapWeight = 1e-9;

/// Twice the area below this, relative to the longest edge squared: a triangle without a usable normal.
constexpr double kFlatTriangle = 1e-12;

/// Corners of a triangle and its unit normal (right-hand rule); the normal is zero when the triangle has no area.
struct TrianglePoints {
  std::array<Vector3, 3> corners;
  Vector3 normal = Vector3::Zero();

  TrianglePoints() = default;
  TrianglePoints(const Vector3& a, const Vector3& b, const Vector3& c);

  Vector3 pointAt(const Vector3& weights) const {
    return weights[0] * corners[0] + weights[1] * corners[1] + weights[2] * corners[2];
  }
};

/// A ball that holds a triangle.
struct TriangleBall {
  Vector3 centre;
  double radius;

  explicit TriangleBall(const std::array<Vector3, 3>& corners);
};

/// Unit normal of a triangle, zero when it is degenerate (kFlatTriangle).
Vector3 triangleNormal(const Vector3& a, const Vector3& b, const Vector3& c);

/// Barycentric weights of the point of the triangle nearest to `p`; exactly 0 for corners it does not depend on. Works
/// on degenerate triangles: there it is the nearest point of the three edges.
Vector3 projectOnTriangle(const std::array<Vector3, 3>& corners, const Vector3& p);

/// Weights below kSnapWeight set to 0: the point lies on the opposite edge.
Vector3 snapped(const Vector3& weights);

/// Parameter in [0, 1] of the point of segment a-b nearest to `p`; 0 when a = b.
double projectOnSegment(const Vector3& a, const Vector3& b, const Vector3& p);

/// Parameter in [0, 1] of the point of segment a-b nearest to segment c-d. One of many when they are parallel.
double nearestOnSegment(const Vector3& a, const Vector3& b, const Vector3& c, const Vector3& d);

/// Weights of the point at parameter `u` of edge `i` (from corner i to corner i + 1).
inline Vector3 weightsOnEdge(int i, double u) {
  Vector3 weights = Vector3::Zero();
  weights[i] = 1.0 - u;
  weights[(i + 1) % 3] = u;
  return weights;
}

}  // namespace tissue_contact
