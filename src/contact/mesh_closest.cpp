/// @file
/// Room `contact`: where on a triangle a mesh is nearest or deepest.
///
/// Where they overlap: cutting planes. The distance at a point and its gradient give a linear function that bounds the
/// distance from below where it is convex; the lowest point of the maximum of all planes so far is where to look next.
/// Near a convex polyhedron this ends at the exact answer once every face involved has been met. Where the mesh is not
/// convex, planes that turn out to lie above the distance are dropped; the answer is then a good point, not always the
/// best. Alternating projection on an inner level set has the fault described in box_distance.cpp.
#include <algorithm>
#include <functional>
#include <limits>

#include "contact/mesh_distance.h"
#include "contact/plane_minimum.h"
#include "contact/tolerances.h"
#include "contact/triangle_pair.h"

namespace tissue_contact {
namespace {

constexpr int kMaxCuts = 16;

/// The planes met so far and the lowest point found.
class CuttingPlanes {
 public:
  CuttingPlanes(const MeshDistance& shape, const TrianglePoints& triangle)
      : shape_(shape), triangle_(triangle), tolerance_(kTie * shape.size()) {}

  /// Distance at a point of the triangle; adds its plane. Returns it.
  double cut(const Vector3& weights) {
    const Vector3 p = triangle_.pointAt(weights);
    const SignedDistance here = shape_.at(p);
    Vector3 corner_values;
    for (int i = 0; i < 3; ++i) corner_values[i] = here.distance + here.normal.dot(triangle_.corners[i] - p);
    if (planes_.full()) drop(lowestPlaneAt(weights));
    planes_.add(corner_values);
    normals_[planes_.count() - 1] = here.normal;
    if (here.distance < lowest_) {
      lowest_ = here.distance;
      lowest_weights_ = weights;
    }
    return here.distance;
  }

  void dropPlanesAboveLowest() {
    for (int i = planes_.count() - 1; i >= 0; --i) {
      if (planes_.valueAt(i, lowest_weights_) > lowest_ + tolerance_) drop(i);
    }
  }

  PlaneMinimum minimum() const { return minimiseMaximum(planes_, tolerance_); }
  double lowest() const { return lowest_; }

  void result(ClosestPoint& closest) const {
    closest.weights = lowest_weights_;
    closest.distance = lowest_;
    closest.gradients = GradientSet();
    for (int i = 0; i < planes_.count(); ++i) {
      if (planes_.valueAt(i, lowest_weights_) >= lowest_ - 2.0 * tolerance_) closest.gradients.add(normals_[i]);
    }
  }

 private:
  void drop(int plane) {
    for (int k = plane; k + 1 < planes_.count(); ++k) normals_[k] = normals_[k + 1];
    planes_.remove(plane);
  }

  int lowestPlaneAt(const Vector3& weights) const {
    int lowest = 0;
    for (int i = 1; i < planes_.count(); ++i) {
      if (planes_.valueAt(i, weights) < planes_.valueAt(lowest, weights)) lowest = i;
    }
    return lowest;
  }

  const MeshDistance& shape_;
  const TrianglePoints& triangle_;
  double tolerance_;
  PlaneSet planes_;
  std::array<Vector3, PlaneSet::kCapacity> normals_;
  double lowest_ = std::numeric_limits<double>::infinity();
  Vector3 lowest_weights_ = Vector3::UnitX();
};

}  // namespace

/// The nearest point of the triangle to the mesh (`exact` if they are apart), or else some point inside their overlap.
/// False when they are farther apart than `margin`.
bool MeshDistance::startingPoint(const TrianglePoints& triangle, double margin, Vector3& weights, bool& exact) const {
  weights = projectOnTriangle(triangle.corners, centre_);
  const double first = at(triangle.pointAt(weights)).distance;
  exact = false;
  if (first < 0.0) return true;
  TrianglePair pair(triangle, kTie * size_);
  double reach = std::min(margin, first) + kTie * size_;
  const auto visit = [&](int other) {
    const Triangle& t = triangles_[other];
    pair.offer({vertices_.col(t[0]), vertices_.col(t[1]), vertices_.col(t[2])}, reach);
    reach = std::min(reach, pair.distance() + kTie * size_);
  };
  tree_.visitNear(triangle, reach, std::cref(visit));
  if (!(pair.distance() <= margin)) return false;
  weights = pair.weights();
  exact = at(triangle.pointAt(weights)).distance > kTie * size_;
  return true;
}

bool MeshDistance::closest(const TrianglePoints& triangle, double margin, ClosestPoint& result) const {
  Vector3 start;
  bool exact = false;
  if (!startingPoint(triangle, margin, start, exact)) return false;
  CuttingPlanes planes(*this, triangle);
  planes.cut(start);
  for (int cuts = 1; !exact && cuts < kMaxCuts; ++cuts) {
    const PlaneMinimum next = planes.minimum();
    if (next.value >= planes.lowest() - kTie * size_) break;
    planes.cut(next.weights);
    planes.dropPlanesAboveLowest();
  }
  planes.result(result);
  if (std::abs(result.distance) <= kTie * size_) {
    result.gradients = GradientSet();
    addFaceNormals(triangle.pointAt(result.weights), result.gradients);
  }
  return result.distance <= margin;
}

/// The directions in which faces meeting at a surface point look, each once.
void MeshDistance::addFaceNormals(const Vector3& p_S, GradientSet& gradients) const {
  const double reach = 2.0 * kTie * size_;
  const Vector3 around = Vector3::Constant(reach);
  tree_.overlapping({Vector3(p_S - around), Vector3(p_S + around)}, found_);
  for (const int triangle : found_) {
    const Triangle& t = triangles_[triangle];
    const TrianglePoints face(vertices_.col(t[0]), vertices_.col(t[1]), vertices_.col(t[2]));
    if ((face.pointAt(projectOnTriangle(face.corners, p_S)) - p_S).norm() > reach) continue;
    bool known = false;
    for (int i = 0; i < gradients.count(); ++i) known |= (gradients[i] - face_normals_[triangle]).norm() < kTie;
    if (!known) gradients.add(face_normals_[triangle]);
  }
}

}  // namespace tissue_contact
