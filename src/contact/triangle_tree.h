/// @file
/// Room `contact`: a bounding-volume tree over triangles (FCL), refitted when they move.
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "contact/triangle_geometry.h"
#include "tissue_contact/core/types.h"

namespace tissue_contact {

struct NearestOnTriangles {
  int triangle = -1;
  Vector3 weights = Vector3::Zero();  ///< barycentric, exactly 0 for corners the point does not depend on
  Vector3 point = Vector3::Zero();
  double distance_squared = 0.0;
};

/// fcl::BVHModel of axis-aligned boxes with a descent of our own: fcl::collide would run GJK at every leaf.
class TriangleTree {
 public:
  TriangleTree(const NodalVectors& positions, std::vector<Triangle> triangles);
  ~TriangleTree();
  TriangleTree(TriangleTree&&) noexcept;
  TriangleTree& operator=(TriangleTree&&) noexcept;

  /// New positions of the same nodes; keeps the tree's structure. No allocation. The result depends on the positions
  /// alone, not on earlier ones.
  void refit(const NodalVectors& positions);

  /// Indices of the triangles whose bounding boxes overlap `box`, ascending.
  void overlapping(const Eigen::AlignedBox3d& box, std::vector<int>& triangles) const;

  /// Calls `visit` with the triangles that may be no farther from `triangle` than `reach` (m), nearer branches first.
  /// `visit` may shorten `reach` as it finds something.
  void visitNear(const TrianglePoints& triangle, const double& reach, const std::function<void(int)>& visit) const;

  /// The nearest point of all triangles to `p` (exact).
  NearestOnTriangles nearest(const Vector3& p) const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace tissue_contact
