#include "contact/contact_direction.h"

#include "contact/conforming_gap.h"
#include "contact/shape/gradient_set.h"

namespace tissue_contact {
namespace {

/// Shortest generalised gradient that still means a direction of contact. The edge of a box gives at least 0.71, its
/// corner 0.58; 0 is where opposite sides of the shape are equally near.
constexpr double kShortestGradient = 0.3;

/// A gradient whose part along its feature is longer than this share of it is not stationary: the search for the
/// closest point ended early or met a part of a mesh that is not convex. The plain gradient is used then.
constexpr double kStationary = 0.1;

/// Of the shape's size: how near to a ridge a point that is kept lies on it.
constexpr double kNearRidge = 1e-3;

/// What of a gradient lies in the surface beside an edge of the tissue counts by this much of what lies along the edge.
constexpr double kBesideEdge = 0.1;

/// Pushing the feature out along a combination of gradients shortens the penetration at the rate of its length.
double gapAlong(double distance, double length) { return distance < 0.0 ? distance / length : distance; }

}  // namespace

Matrix3 tangentOf(const TrianglePoints& points, const Vector3& weights) {
  const int corners = static_cast<int>((weights.array() > 0.0).count());
  if (corners == 1) return Matrix3::Zero();
  if (corners == 3) return Matrix3::Identity() - points.normal * points.normal.transpose();
  int opposite = 0;
  weights.minCoeff(&opposite);
  const Vector3 edge = (points.corners[(opposite + 2) % 3] - points.corners[(opposite + 1) % 3]).normalized();
  return edge * edge.transpose();
}

SignedDistance contactDirection(const ClosestPoint& closest, const Matrix3& tangent) {
  if (closest.gradients.count() == 0) return {0.0, Vector3::Zero()};
  const Vector3 gradient = stationaryGradient(closest.gradients, tangent);
  const double length = gradient.norm();
  if (!(length > kShortestGradient)) return {0.0, Vector3::Zero()};
  const Vector3 along = tangent * gradient;
  if (along.norm() > kStationary * length) return {closest.distance, closest.gradients[0]};
  return {gapAlong(closest.distance, length), (gradient - along).normalized()};
}

SignedDistance keptContact(const ShapeDistance& shape, const TrianglePoints& points, const Vector3& weights) {
  std::array<double, 3> distances;
  for (int i = 0; i < 3; ++i) distances[i] = shape.at(points.corners[i]).distance;
  const Vector3 p = points.pointAt(weights);
  const SignedDistance here = shape.at(p);
  const double bent = conformingGap(points.corners, distances, weights, here.distance).gap;
  SignedDistance plain = {bent, here.normal};
  const double reach = kNearRidge * shape.size();
  const bool is_vertex = weights.maxCoeff() == 1.0;
  if (is_vertex || here.distance > reach) return plain;
  GradientSet gradients;
  shape.gradientsNear(p, reach, gradients);
  if (gradients.count() < 2) return plain;
  // Along an edge that lies on the ridge no normal has a part: the surface beside it decides.
  const Vector3& n = points.normal;
  const Matrix3 tangent = tangentOf(points, weights) + kBesideEdge * (Matrix3::Identity() - n * n.transpose());
  const Vector3 gradient = stationaryGradient(gradients, tangent);
  const double length = gradient.norm();
  if (!(length > kShortestGradient)) return plain;
  return {gapAlong(here.distance, length) + bent - here.distance, gradient / length};
}

}  // namespace tissue_contact
