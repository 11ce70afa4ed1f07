/// @file
/// Room `contact`: a mesh shape as a sampled signed distance.
#pragma once

#include <memory>

#include "contact/distance_grid.h"
#include "contact/shape_distance.h"

namespace tissue_contact {

class FieldDistance : public ShapeDistance {
 public:
  explicit FieldDistance(std::shared_ptr<const DistanceGrid> grid, const Vector3& centre, const Vector3& half);

  double size() const override { return size_; }
  Vector3 halfExtents(const Matrix3& R_WS) const override { return R_WS.cwiseAbs() * half_; }
  Vector3 boxCentre() const override { return centre_; }
  SignedDistance at(const Vector3& p_S) const override;
  bool closest(const TrianglePoints& triangle, double margin, ClosestPoint& result) const override;

 private:
  std::shared_ptr<const DistanceGrid> grid_;
  Vector3 centre_;
  Vector3 half_;
  double size_;
  double tolerance_;
};

}  // namespace tissue_contact
