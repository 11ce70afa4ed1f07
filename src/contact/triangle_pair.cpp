#include "contact/triangle_pair.h"

#include "contact/tolerances.h"

namespace tissue_contact {
namespace {

Vector3 pointAt(const std::array<Vector3, 3>& corners, const Vector3& weights) {
  return weights[0] * corners[0] + weights[1] * corners[1] + weights[2] * corners[2];
}

/// Whether segment a-b crosses the triangle, and where.
bool crosses(const Vector3& a, const Vector3& b, const std::array<Vector3, 3>& corners, Vector3& where) {
  const Vector3 normal = triangleNormal(corners[0], corners[1], corners[2]);
  const double from = normal.dot(a - corners[0]);
  const double to = normal.dot(b - corners[0]);
  if (!(from * to < 0.0)) return false;
  where = a + from / (from - to) * (b - a);
  return (pointAt(corners, projectOnTriangle(corners, where)) - where).norm() <= kTouch * (b - a).norm();
}

}  // namespace

void TrianglePair::offer(const std::array<Vector3, 3>& other, double reach) {
  Vector3 heights;
  for (int i = 0; i < 3; ++i) heights[i] = triangle_.normal.dot(other[i] - triangle_.corners[0]);
  const bool one_side = heights.minCoeff() > 0.0 || heights.maxCoeff() < 0.0;
  if (one_side && (crossings_ > 0 || heights.cwiseAbs().minCoeff() > reach)) return;
  if (!one_side) offerCrossings(other);
  if (crossings_ > 0) return;  // the distance is 0 whatever else is near
  for (int i = 0; i < 3; ++i) {
    const Vector3& own = triangle_.corners[i];
    nearest_.add(Vector3::Unit(i), (pointAt(other, projectOnTriangle(other, own)) - own).norm());
    const Vector3 weights = projectOnTriangle(triangle_.corners, other[i]);
    nearest_.add(weights, (triangle_.pointAt(weights) - other[i]).norm());
  }
  offerEdges(other);
}

void TrianglePair::offerEdges(const std::array<Vector3, 3>& other) {
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < 3; ++k) {
      const Vector3& from = other[k];
      const Vector3& to = other[(k + 1) % 3];
      const Vector3 weights =
          weightsOnEdge(i, nearestOnSegment(triangle_.corners[i], triangle_.corners[(i + 1) % 3], from, to));
      const Vector3 p = triangle_.pointAt(weights);
      nearest_.add(weights, (from + projectOnSegment(from, to, p) * (to - from) - p).norm());
    }
  }
}

void TrianglePair::offerCrossings(const std::array<Vector3, 3>& other) {
  Vector3 where;
  for (int i = 0; i < 3; ++i) {
    const int next = (i + 1) % 3;
    if (crosses(other[i], other[next], triangle_.corners, where)) addCrossing(where);
    if (crosses(triangle_.corners[i], triangle_.corners[next], other, where)) addCrossing(where);
  }
}

void TrianglePair::addCrossing(const Vector3& p) {
  crossing_sum_ += projectOnTriangle(triangle_.corners, p);
  ++crossings_;
}

}  // namespace tissue_contact
