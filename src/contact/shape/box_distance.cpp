/// @file
/// Room `contact`: box.
///
/// Where on a triangle the box is nearest: let psi be the largest of the six distances to the planes of the faces. psi
/// is the signed distance phi inside and in front of a face, and below it beyond edges and corners. Its minimum over a
/// triangle is found exactly (minimiseMaximum). If phi = psi there, that point minimises phi too. Otherwise the
/// triangle is clear of the box and near one of its edges or corners: then some corner of one and face of the other, or
/// an edge of each, are nearest, and all pairs are tried.
///
/// Why not GJK (FCL 0.7):
///  - clear of the box its independent solver (tolerance 1e-12, unit size) stopped early on 53 of 17 373 random
///    triangles and reported success, with gaps up to 0.3 mm too large for a 20 x 12 x 8 mm box; all pairs take 1 us,
///    GJK 2.5 us; and where an edge is parallel to the triangle it returns one end of the overlap or the other, all
///    pairs the middle;
///  - against a box shrunk to stay clear in shallow contact it finds the point nearest to the shrunk box's edge: for a
///    20 mm box tilted by 20 degrees, shrunk by 5 mm, that is 3 mm beside the real edge, the gap 1.1 mm too large.
#include <algorithm>

#include "contact/shape/plane_minimum.h"
#include "contact/shape/shape_distance.h"
#include "contact/shape/soft_minimum.h"
#include "contact/tolerances.h"

namespace tissue_contact {
namespace {

class BoxDistance : public ShapeDistance {
 public:
  explicit BoxDistance(const Vector3& half_extents) : half_(half_extents), size_(half_extents.minCoeff()) {}

  double size() const override { return size_; }
  Vector3 halfExtents(const Matrix3& R_WS) const override { return R_WS.cwiseAbs() * half_; }
  SignedDistance at(const Vector3& p_S) const override;
  double toRidge(const Vector3& p_S) const override;
  void gradientsNear(const Vector3& p_S, double reach, GradientSet& gradients) const override;
  bool closest(const TrianglePoints& triangle, double margin, ClosestPoint& result) const override;
  void foremostCorners(const Vector3& forward, const Eigen::AlignedBox3d& box,
                       std::vector<ShapeCorner>& corners) const override;

 private:
  Vector3 corner(int index) const {
    return {index & 1 ? half_.x() : -half_.x(), index & 2 ? half_.y() : -half_.y(), index & 4 ? half_.z() : -half_.z()};
  }
  PlaneSet facePlanes(const TrianglePoints& triangle) const;
  void findBeyondFaces(const TrianglePoints& triangle, ClosestPoint& result) const;
  void offerEdgePairs(const TrianglePoints& triangle, const Vector3& from, const Vector3& to,
                      SoftMinimum& minimum) const;
  void offer(const TrianglePoints& triangle, const Vector3& weights, SoftMinimum& minimum) const {
    minimum.add(weights, at(triangle.pointAt(weights)).distance);
  }

  Vector3 half_;
  double size_;
};

/// +1 or -1: the side of the box a coordinate is on. Not 0 at 0, so that the normal there is one of the two.
double side(double coordinate) { return coordinate < 0.0 ? -1.0 : 1.0; }

SignedDistance BoxDistance::at(const Vector3& p_S) const {
  const Vector3 beyond = p_S.cwiseAbs() - half_;
  const Vector3 outside = beyond.cwiseMax(0.0);
  const double distance = outside.norm();
  if (distance > kTouch * size_) {
    return {distance,
            Vector3(side(p_S.x()) * outside.x(), side(p_S.y()) * outside.y(), side(p_S.z()) * outside.z()) / distance};
  }
  int axis = 0;
  const double deepest = beyond.maxCoeff(&axis);
  return {distance > 0.0 ? distance : deepest, side(p_S[axis]) * Vector3::Unit(axis)};
}

double BoxDistance::toRidge(const Vector3& p_S) const {
  Vector3 beyond = p_S.cwiseAbs() - half_;
  std::sort(beyond.data(), beyond.data() + 3);
  if (beyond[2] <= 0.0) return beyond[2] - beyond[1];         // inside, between two faces
  return std::min(std::abs(beyond[1]), std::abs(beyond[0]));  // where a face, an edge or a corner begins
}

PlaneSet BoxDistance::facePlanes(const TrianglePoints& triangle) const {
  PlaneSet planes;
  for (int axis = 0; axis < 3; ++axis) {
    const Vector3 coordinates(triangle.corners[0][axis], triangle.corners[1][axis], triangle.corners[2][axis]);
    planes.add((coordinates.array() - half_[axis]).matrix());
    planes.add((-coordinates.array() - half_[axis]).matrix());
  }
  return planes;
}

bool BoxDistance::closest(const TrianglePoints& triangle, double margin, ClosestPoint& result) const {
  const PlaneMinimum minimum = minimiseMaximum(facePlanes(triangle), kTie * size_);
  if (minimum.value > margin) return false;  // psi <= phi
  result.weights = minimum.weights;
  result.gradients = GradientSet();
  const Vector3 p = triangle.pointAt(result.weights);
  const SignedDistance here = at(p);
  result.distance = here.distance;
  if (here.distance <= kTie * size_) {
    gradientsNear(p, kTie * size_, result.gradients);
  } else if (here.distance > minimum.value + kTouch * size_) {
    findBeyondFaces(triangle, result);
  } else {
    result.gradients.add(here.normal);
  }
  return result.distance <= margin;
}

void BoxDistance::gradientsNear(const Vector3& p, double reach, GradientSet& gradients) const {
  const Vector3 beyond = p.cwiseAbs() - half_;
  const double active = beyond.maxCoeff() - 2.0 * reach;
  for (int axis = 0; axis < 3; ++axis) {
    if (beyond[axis] < active) continue;
    gradients.add(side(p[axis]) * Vector3::Unit(axis));
    // In the middle of a plate both faces are equally near.
    if (-std::abs(p[axis]) - half_[axis] >= active) gradients.add(-side(p[axis]) * Vector3::Unit(axis));
  }
}

void BoxDistance::findBeyondFaces(const TrianglePoints& triangle, ClosestPoint& result) const {
  SoftMinimum minimum(kTie * size_);
  for (int i = 0; i < 3; ++i) offer(triangle, Vector3::Unit(i), minimum);
  for (int index = 0; index < 8; ++index) {
    const Vector3 from = corner(index);
    offer(triangle, projectOnTriangle(triangle.corners, from), minimum);
    for (int axis = 0; axis < 3; ++axis) {
      if (!(index & (1 << axis))) offerEdgePairs(triangle, from, corner(index | (1 << axis)), minimum);
    }
  }
  result.weights = minimum.weights();
  const SignedDistance there = at(triangle.pointAt(result.weights));
  result.distance = there.distance;
  result.gradients.add(there.normal);
}

void BoxDistance::offerEdgePairs(const TrianglePoints& triangle, const Vector3& from, const Vector3& to,
                                 SoftMinimum& minimum) const {
  for (int i = 0; i < 3; ++i) {
    const double u = nearestOnSegment(triangle.corners[i], triangle.corners[(i + 1) % 3], from, to);
    offer(triangle, weightsOnEdge(i, u), minimum);
  }
}

void BoxDistance::foremostCorners(const Vector3& forward, const Eigen::AlignedBox3d& box,
                                  std::vector<ShapeCorner>& corners) const {
  corners.clear();
  for (int index = 0; index < 8; ++index) {
    const Vector3 p = corner(index);
    const Vector3 outward(side(p.x()) * forward.x(), side(p.y()) * forward.y(), side(p.z()) * forward.z());
    if (outward.minCoeff() >= -kCornerSlope && box.contains(p)) corners.push_back({index, p});
  }
}

}  // namespace

std::unique_ptr<ShapeDistance> makeBoxDistance(const Vector3& half_extents) {
  return std::make_unique<BoxDistance>(half_extents);
}

}  // namespace tissue_contact
