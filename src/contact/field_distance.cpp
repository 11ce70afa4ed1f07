#include "contact/field_distance.h"

#include <limits>
#include <cstdlib>
#include "contact/lowest_on_triangle.h"
#include "contact/sample_distance.h"
#include "contact/tolerances.h"

namespace tissue_contact {

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
  return lowestOnTriangle(*grid_, triangle, margin, result);
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
