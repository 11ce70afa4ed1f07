#include "contact/field_distance.h"

#include <limits>
#include <cstdlib>
#include "contact/plane_minimum.h"
#include "contact/sample_distance.h"
#include "contact/tolerances.h"

namespace tissue_contact {
namespace {

constexpr int kMaxCuts = 16;

class CuttingPlanes {
 public:
  CuttingPlanes(const DistanceGrid& grid, const TrianglePoints& triangle, double tolerance)
      : grid_(grid), triangle_(triangle), tolerance_(tolerance) {}

  double cut(const Vector3& weights) {
    const Vector3 p = triangle_.pointAt(weights);
    const GridSample here = grid_.at(p);
    Vector3 corner_values;
    for (int i = 0; i < 3; ++i) corner_values[i] = here.distance + here.gradient.dot(triangle_.corners[i] - p);
    if (planes_.full()) drop(lowestPlaneAt(weights));
    planes_.add(corner_values);
    normals_[planes_.count() - 1] = here.gradient;
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

  const DistanceGrid& grid_;
  const TrianglePoints& triangle_;
  double tolerance_;
  PlaneSet planes_;
  std::array<Vector3, PlaneSet::kCapacity> normals_;
  double lowest_ = std::numeric_limits<double>::infinity();
  Vector3 lowest_weights_ = Vector3::UnitX();
};

}  // namespace

FieldDistance::FieldDistance(std::shared_ptr<const DistanceGrid> grid, const Vector3& centre, const Vector3& half)
    : grid_(std::move(grid)), centre_(centre), half_(half), size_(half.minCoeff()), tolerance_(0.01 * grid_->spacing) {}

SignedDistance FieldDistance::at(const Vector3& p_S) const {
  if (!p_S.allFinite()) return {std::numeric_limits<double>::quiet_NaN(), Vector3::UnitX()};
  const GridSample here = grid_->at(p_S);
  const double length = here.gradient.norm();
  if (!(length > 1e-9)) return {here.distance, Vector3::UnitX()};  // a maximum or minimum: every direction is as good
  return {here.distance, here.gradient / length};
}

bool FieldDistance::closest(const TrianglePoints& triangle, double margin, ClosestPoint& result) const {
  const Eigen::AlignedBox3d box(Vector3(centre_ - half_), Vector3(centre_ + half_));
  Eigen::AlignedBox3d around;
  for (const Vector3& p : triangle.corners) around.extend(p);
  if (around.exteriorDistance(box) > margin) return false;
  if (!triangle.normal.isZero(0.0)) {
    const double reach = triangle.normal.cwiseAbs().dot(half_) + margin;
    if (std::abs(triangle.normal.dot(centre_ - triangle.corners[0])) > reach) return false;
  }
  CuttingPlanes planes(*grid_, triangle, tolerance_);
  planes.cut(projectOnTriangle(triangle.corners, centre_));
  for (int cuts = 1; cuts < kMaxCuts; ++cuts) {
    const PlaneMinimum next = planes.minimum();
    if (next.value >= planes.lowest() - tolerance_) break;
    planes.cut(next.weights);
    planes.dropPlanesAboveLowest();
  }
  planes.result(result);
  result.beyond_rim = false;
  return result.distance <= margin;
}

std::unique_ptr<ShapeDistance> makeFieldDistance(const TriangleMesh& mesh) {
  const Vector3 low = mesh.vertices.rowwise().minCoeff();
  const Vector3 high = mesh.vertices.rowwise().maxCoeff();
  const double pad = 1e-3;
  const double budget = std::getenv("FIELD_NODES") ? std::atof(std::getenv("FIELD_NODES")) : 1e6;
  const double h = std::cbrt((high - low + Vector3::Constant(2 * pad)).prod() / budget);
  const SurfaceTree tree(mesh);
  auto grid = std::make_shared<const DistanceGrid>(sampleDistance(tree, planGrid(mesh, h, pad)));
  return std::make_unique<FieldDistance>(grid, 0.5 * (low + high), 0.5 * (high - low));
}

}  // namespace tissue_contact
