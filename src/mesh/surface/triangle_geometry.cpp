#include "mesh/surface/triangle_geometry.h"

#include <algorithm>
#include <cmath>
#include <limits>

namespace tissue_contact {
namespace {

double longestEdgeSquared(const Vector3& ab, const Vector3& ac) {
  return std::max({ab.squaredNorm(), ac.squaredNorm(), (ac - ab).squaredNorm()});
}

bool isFlat(double normal_squared, double edge_squared) {
  const double limit = kFlatTriangle * edge_squared;
  return !(normal_squared > limit * limit);
}

}  // namespace

TrianglePoints::TrianglePoints(const Vector3& a, const Vector3& b, const Vector3& c)
    : corners{a, b, c}, normal(triangleNormal(a, b, c)) {}

TriangleBall::TriangleBall(const std::array<Vector3, 3>& corners) {
  const auto& [a, b, c] = corners;
  centre = (a + b + c) / 3.0;
  radius = std::sqrt(std::max({(a - centre).squaredNorm(), (b - centre).squaredNorm(), (c - centre).squaredNorm()}));
}

Vector3 triangleNormal(const Vector3& a, const Vector3& b, const Vector3& c) {
  const Vector3 ab = b - a;
  const Vector3 ac = c - a;
  const Vector3 n = ab.cross(ac);
  const double squared = n.squaredNorm();
  if (isFlat(squared, longestEdgeSquared(ab, ac))) return Vector3::Zero();
  return n / std::sqrt(squared);
}

Vector3 snapped(const Vector3& weights) {
  Vector3 result = weights;
  for (int i = 0; i < 3; ++i) {
    if (result[i] < kSnapWeight) result[i] = 0.0;
  }
  return result / result.sum();
}

double projectOnSegment(const Vector3& a, const Vector3& b, const Vector3& p) {
  const Vector3 ab = b - a;
  const double along = (p - a).dot(ab);
  const double length_squared = ab.squaredNorm();
  if (!(along > 0.0)) return 0.0;
  return along < length_squared ? along / length_squared : 1.0;
}

Vector3 projectOnTriangle(const std::array<Vector3, 3>& corners, const Vector3& p) {
  const Vector3 ab = corners[1] - corners[0];
  const Vector3 ac = corners[2] - corners[0];
  const Vector3 ap = p - corners[0];
  const Vector3 n = ab.cross(ac);
  const double squared = n.squaredNorm();
  const double b = ap.cross(ac).dot(n);
  const double c = ab.cross(ap).dot(n);
  const double a = squared - b - c;
  if (a > 0.0 && b > 0.0 && c > 0.0 && !isFlat(squared, longestEdgeSquared(ab, ac))) {
    return Vector3(a, b, c) / squared;
  }
  Vector3 nearest = Vector3::UnitX();
  double nearest_squared = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 3; ++i) {
    const Vector3& from = corners[i];
    const Vector3& to = corners[(i + 1) % 3];
    const double u = projectOnSegment(from, to, p);
    const double distance_squared = (from + u * (to - from) - p).squaredNorm();
    if (distance_squared < nearest_squared) {
      nearest_squared = distance_squared;
      nearest = weightsOnEdge(i, u);
    }
  }
  return nearest;
}

double nearestOnSegment(const Vector3& a, const Vector3& b, const Vector3& c, const Vector3& d) {
  const Vector3 ab = b - a;
  const Vector3 cd = d - c;
  const Vector3 ca = a - c;
  const double ab2 = ab.squaredNorm();
  const double cd2 = cd.squaredNorm();
  const double mixed = ab.dot(cd);
  const double determinant = ab2 * cd2 - mixed * mixed;
  double u = 0.0;
  if (determinant > 0.0) u = std::clamp((mixed * cd.dot(ca) - cd2 * ab.dot(ca)) / determinant, 0.0, 1.0);
  const double v = projectOnSegment(c, d, a + u * ab);
  return projectOnSegment(a, b, c + v * cd);
}

}  // namespace tissue_contact
