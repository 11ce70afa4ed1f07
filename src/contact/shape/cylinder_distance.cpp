/// @file
/// Room `contact`: cylinder, axis along z.
///
/// Where on a triangle the cylinder is nearest: as for the box (box_distance.cpp), with psi the larger of the distance
/// to the side (of the endless cylinder) and to the nearer cap plane. Every point that can minimise psi over a triangle
/// has a closed form; all are tried that the triangle's place leaves: most see the side alone, or a cap.
#include <algorithm>
#include <cmath>
#include <limits>

#include "contact/shape/shape_distance.h"
#include "contact/shape/soft_minimum.h"
#include "contact/tolerances.h"

namespace tissue_contact {
namespace {

class CylinderDistance : public ShapeDistance {
 public:
  CylinderDistance(double radius, double half_length)
      : radius_(radius), half_length_(half_length), size_(std::min(radius, half_length)) {}

  double size() const override { return size_; }
  Vector3 halfExtents(const Matrix3& R_WS) const override {
    const Vector3 axis = R_WS.col(2);
    return half_length_ * axis.cwiseAbs() + radius_ * (1.0 - axis.array().square()).max(0.0).sqrt().matrix();
  }
  SignedDistance at(const Vector3& p_S) const override;
  double toRidge(const Vector3& p_S) const override {
    const double side = beyondSide(p_S), cap = beyondCap(p_S);
    return side > 0.0 && cap > 0.0 ? side + cap : std::abs(side - cap);
  }
  void gradientsNear(const Vector3& p_S, double reach, GradientSet& gradients) const override;
  bool closest(const TrianglePoints& triangle, double margin, ClosestPoint& result) const override;

 private:
  double beyondSide(const Vector3& p) const { return std::sqrt(p.x() * p.x() + p.y() * p.y()) - radius_; }
  double beyondCap(const Vector3& p) const { return std::abs(p.z()) - half_length_; }
  double beyondPlanes(const Vector3& p) const { return std::max(beyondSide(p), beyondCap(p)); }

  void offer(const TrianglePoints& triangle, const Vector3& weights, SoftMinimum& minimum) const {
    minimum.add(weights, beyondPlanes(triangle.pointAt(weights)));
  }
  void offerOnEdge(const TrianglePoints& triangle, int edge, double u, SoftMinimum& minimum) const {
    if (u > 0.0 && u < 1.0) offer(triangle, weightsOnEdge(edge, u), minimum);
  }
  void offerEdge(const TrianglePoints& triangle, int edge, bool sees_side, bool sees_cap, SoftMinimum& minimum) const;
  void offerInside(const TrianglePoints& triangle, SoftMinimum& minimum) const;
  bool nearestInside(const TrianglePoints& triangle, Vector3& weights) const;
  double nearestOnEdge(const Vector3& a, const Vector3& d) const;
  void findBeyondRim(const TrianglePoints& triangle, ClosestPoint& result) const;

  double radius_;
  double half_length_;
  double size_;
};

/// Outward direction of the side at p; x on the axis itself, where all are gradients.
Vector3 radialDirection(const Vector3& p) {
  const double from_axis = std::sqrt(p.x() * p.x() + p.y() * p.y());
  return from_axis > 0.0 ? Vector3(p.x() / from_axis, p.y() / from_axis, 0.0) : Vector3::UnitX();
}

Vector3 capNormal(const Vector3& p) { return {0.0, 0.0, p.z() < 0.0 ? -1.0 : 1.0}; }

SignedDistance CylinderDistance::at(const Vector3& p_S) const {
  const double side = beyondSide(p_S);
  const double cap = beyondCap(p_S);
  if (side > 0.0 && cap > 0.0) {
    const double distance = std::sqrt(side * side + cap * cap);
    if (distance > kTouch * size_) {
      return {distance, (side * radialDirection(p_S) + cap * capNormal(p_S)) / distance};
    }
    return {distance, side > cap ? radialDirection(p_S) : capNormal(p_S)};
  }
  return {std::max(side, cap), side > cap ? radialDirection(p_S) : capNormal(p_S)};
}

bool CylinderDistance::closest(const TrianglePoints& triangle, double margin, ClosestPoint& result) const {
  const TriangleBall ball(triangle.corners);
  // No distance changes by more than the way, their difference by no more than twice that.
  const double side_beyond_cap = beyondSide(ball.centre) - beyondCap(ball.centre);
  const bool sees_side = side_beyond_cap > -2.0 * ball.radius;
  const bool sees_cap = side_beyond_cap < 2.0 * ball.radius;
  SoftMinimum minimum(kTie * size_);
  for (int i = 0; i < 3; ++i) {
    offer(triangle, Vector3::Unit(i), minimum);
    offerEdge(triangle, i, sees_side, sees_cap, minimum);
  }
  const bool meets_axis = beyondSide(ball.centre) + radius_ <= ball.radius;
  if ((sees_side && sees_cap) || meets_axis) offerInside(triangle, minimum);
  if (minimum.lowest() > margin) return false;  // psi <= phi
  result.weights = minimum.weights();
  result.gradients = GradientSet();
  result.beyond_rim = false;
  const Vector3 p = triangle.pointAt(result.weights);
  const SignedDistance here = at(p);
  result.distance = here.distance;
  if (here.distance <= kTie * size_) {
    gradientsNear(p, kTie * size_, result.gradients);
  } else if (here.distance > beyondPlanes(p) + kTouch * size_) {
    findBeyondRim(triangle, result);
  } else {
    result.gradients.add(here.normal);
  }
  return result.distance <= margin;
}

/// Points of an edge a + u d where psi can be least: nearest to the axis; z = 0; and where side and cap are equally
/// far, (a + u d)_xy^2 = (radius - half length +- z)^2.
void CylinderDistance::offerEdge(const TrianglePoints& triangle, int edge, bool sees_side, bool sees_cap,
                                 SoftMinimum& minimum) const {
  const Vector3& a = triangle.corners[edge];
  const Vector3 d = triangle.corners[(edge + 1) % 3] - a;
  const double across = d.x() * d.x() + d.y() * d.y();
  const double mixed = a.x() * d.x() + a.y() * d.y();
  if (sees_side) offerOnEdge(triangle, edge, -mixed / across, minimum);
  if (sees_cap) offerOnEdge(triangle, edge, -a.z() / d.z(), minimum);
  if (!sees_side || !sees_cap) return;
  for (const double sign : {-1.0, 1.0}) {
    const double offset = radius_ - half_length_ + sign * a.z();
    const double square = across - d.z() * d.z();
    const double linear = mixed - sign * d.z() * offset;
    const double constant = a.x() * a.x() + a.y() * a.y() - offset * offset;
    const double discriminant = linear * linear - square * constant;
    if (!(discriminant >= 0.0)) continue;
    const double q = -(linear + std::copysign(std::sqrt(discriminant), linear));
    offerOnEdge(triangle, edge, q / square, minimum);
    offerOnEdge(triangle, edge, constant / q, minimum);
  }
}

/// Inner points: where the axis passes; where the line z = 0 is nearest to the axis; and where side and cap are equally
/// far and a combination of their normals is the triangle's normal N, which puts the point in direction +-N_xy from the
/// axis. Each is projected on the triangle, so that one outside does no harm.
void CylinderDistance::offerInside(const TrianglePoints& triangle, SoftMinimum& minimum) const {
  if (triangle.normal.isZero(0.0)) return;
  const auto offerPoint = [&](const Vector3& p) {
    if (p.allFinite()) offer(triangle, projectOnTriangle(triangle.corners, p), minimum);
  };
  const Vector3& n = triangle.normal;
  const double height = n.dot(triangle.corners[0]);
  const double tilt = std::sqrt(n.x() * n.x() + n.y() * n.y());
  offerPoint({0.0, 0.0, height / n.z()});
  if (!(tilt > 0.0)) return;
  const Vector3 direction(n.x() / tilt, n.y() / tilt, 0.0);
  for (const double towards : {-1.0, 1.0}) {
    for (const double cap : {-1.0, 1.0}) {
      const double offset = radius_ - half_length_;
      const double z = (height - towards * tilt * offset) / (n.z() + towards * cap * tilt);
      offerPoint(towards * (offset + cap * z) * direction + z * Vector3::UnitZ());
    }
  }
  // Needed only where both caps are equally far; elsewhere it may tie with the ends of a line of contact and must not
  // displace their mean.
  const Vector3 middle = projectOnTriangle(triangle.corners, height / tilt * direction);
  if (beyondPlanes(triangle.pointAt(middle)) < minimum.lowest() - kTie * size_) offer(triangle, middle, minimum);
}

void CylinderDistance::gradientsNear(const Vector3& p, double reach, GradientSet& gradients) const {
  const double active = beyondPlanes(p) - 2.0 * reach;
  if (beyondSide(p) >= active) {
    gradients.add(radialDirection(p));
    if (beyondSide(p) + radius_ <= reach) {  // on the axis
      gradients.add(-radialDirection(p));
      gradients.add(Vector3::UnitZ().cross(radialDirection(p)));
      gradients.add(radialDirection(p).cross(Vector3::UnitZ()));
    }
  }
  if (beyondCap(p) >= active) gradients.add(capNormal(p));
  if (-std::abs(p.z()) - half_length_ >= active) gradients.add(-capNormal(p));
}

/// The point below the cylinder's foremost point towards the triangle's plane, if the triangle holds it. Where that is a
/// line or a cap, its end or middle is taken: if the triangle holds another point of it only, an edge is as near.
bool CylinderDistance::nearestInside(const TrianglePoints& triangle, Vector3& weights) const {
  if (triangle.normal.isZero(0.0)) return false;
  const double height = triangle.normal.dot(triangle.corners[0]);
  const Vector3 n = std::copysign(1.0, height) * triangle.normal;
  const double tilt = std::sqrt(n.x() * n.x() + n.y() * n.y());
  const double towards = tilt > 0.0 ? radius_ / tilt : 0.0;
  const Vector3 foremost(towards * n.x(), towards * n.y(), std::copysign(half_length_, n.z()));
  if (!(n.dot(foremost) < std::abs(height))) return false;  // the plane cuts the cylinder
  weights = projectOnTriangle(triangle.corners, foremost);
  return weights.minCoeff() > 0.0;
}

/// Parameter in [0, 1] of the point of a + u d nearest to the cylinder: the distance is convex along it, so its slope has one root;
/// by the Illinois rule (Dowell & Jarratt, BIT 11 (1971) 168-174).
double CylinderDistance::nearestOnEdge(const Vector3& a, const Vector3& d) const {
  constexpr int kMaxSteps = 54;
  constexpr double kRoundOff = 1e-15;
  const auto slopeAt = [&](double u) { return at(a + u * d).normal.dot(d); };
  double low = 0.0, high = 1.0;
  double at_low = slopeAt(low), at_high = slopeAt(high);
  if (!(at_low < 0.0)) return low;
  if (!(at_high > 0.0)) return high;
  double u = low;
  int side = 0;  // of the root that the last u was on
  for (int step = 0; step < kMaxSteps; ++step) {
    const double before = u;
    u = (low * at_high - high * at_low) / (at_high - at_low);
    const double slope = slopeAt(u);
    if (slope == 0.0 || std::abs(u - before) < kRoundOff) break;
    if (slope < 0.0) {
      low = u;
      at_low = slope;
      if (side < 0) at_high *= 0.5;  // else the other end would stay where it is
    } else {
      high = u;
      at_high = slope;
      if (side > 0) at_low *= 0.5;
    }
    side = slope < 0.0 ? -1 : 1;
  }
  return u;
}

/// By location, not by value: distances that differ by round-off are 1e-8 of the size apart.
void CylinderDistance::findBeyondRim(const TrianglePoints& triangle, ClosestPoint& result) const {
  result.beyond_rim = true;
  if (!nearestInside(triangle, result.weights)) {
    double least = std::numeric_limits<double>::infinity();
    for (int edge = 0; edge < 3; ++edge) {
      const Vector3& a = triangle.corners[edge];
      const double u = nearestOnEdge(a, triangle.corners[(edge + 1) % 3] - a);
      const double distance = at(triangle.pointAt(weightsOnEdge(edge, u))).distance;
      if (!(distance < least)) continue;
      least = distance;
      result.weights = weightsOnEdge(edge, u);
    }
  }
  const SignedDistance there = at(triangle.pointAt(result.weights));
  result.distance = there.distance;
  result.gradients.add(there.normal);
}

}  // namespace

std::unique_ptr<ShapeDistance> makeCylinderDistance(double radius, double half_length) {
  return std::make_unique<CylinderDistance>(radius, half_length);
}

}  // namespace tissue_contact
