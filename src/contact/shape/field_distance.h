/// @file
/// Room `contact`: a mesh shape as a sampled signed distance.
#pragma once

#include <memory>
#include <optional>

#include "contact/shape/mesh_field.h"
#include "contact/shape/shape_distance.h"

namespace tissue_contact {

/// The distance changes by no more than the way between two points, its normal without jumps but on ridges inside. It is
/// exact to some hundredths of the grid's spacing beside flat and gently curved faces; edges are rounded by about one
/// spacing. No corners but the tips of needles: a closest point per triangle, the tissue's vertices and the points that
/// ContactMemory keeps.
class FieldDistance : public ShapeDistance {
 public:
  explicit FieldDistance(std::shared_ptr<const MeshField> field);

  double size() const override { return size_; }
  Vector3 halfExtents(const Matrix3& R_WS) const override;
  Vector3 boxCentre() const override;
  SignedDistance at(const Vector3& p_S) const override;
  /// The mesh's nearest point as the grid has it, by way of where the way to that enters the grid: never less than the distance to the mesh
  /// but for the grid's own error, and more only where a part narrower than a twentieth of the mesh stands out.
  SignedDistance atAnyDistance(const Vector3& p_S) const override;
  double edgeRadius() const override { return field_->grid.spacing; }
  const TriangleMesh* drawn() const override;
  /// The tips alone: rounded edges and corners need none.
  void foremostCorners(const Vector3& forward, const Eigen::AlignedBox3d& box,
                       std::vector<ShapeCorner>& corners) const override;
  double cornerReach() const override { return half_.minCoeff(); }
  bool closest(const TrianglePoints& triangle, double margin, ClosestPoint& result) const override;

 private:
  /// Triangle and gradients in the frame of the grid.
  bool closestInGrid(const TrianglePoints& triangle, double margin, ClosestPoint& result) const;

  std::shared_ptr<const MeshField> field_;
  Vector3 centre_;  ///< of the box around the mesh, in the frame of the grid
  Vector3 half_;
  double size_;
  bool is_turned_;                             ///< the grid lies across the shape's axes
  mutable std::optional<TriangleMesh> drawn_;  ///< made when first asked for: a replay draws nothing
};

}  // namespace tissue_contact
