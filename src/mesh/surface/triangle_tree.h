/// @file
/// Room `mesh`, private: a binary tree of axis-aligned boxes over triangles.
///
/// FCL builds the tree, once. Its nodes are kept here, because FCL's refit and its questions cost more than the step can
/// spare: a refit takes 28 us for 720 triangles, and at every leaf a traversal runs a narrow phase, where a box only asks
/// which triangles are near.
#pragma once

#include <vector>

#include "tissue_contact/core/types.h"

namespace tissue_contact {

class TriangleTree {
 public:
  struct Node {
    Eigen::AlignedBox3d box;
    int triangle = -1;  ///< of a leaf, else -1
    int children = -1;  ///< the left one, the right one follows it; -1 for a leaf
  };

  /// @param x 3 x n, m.
  /// @param triangles indices in range.
  TriangleTree(const NodalVectors& x, std::vector<Triangle> triangles);

  /// New positions of the same nodes. No allocation. The boxes depend on the positions alone, not on earlier ones.
  void refit(const NodalVectors& x);

  /// Indices of the triangles whose bounding boxes overlap `box`, ascending.
  void overlapping(const Eigen::AlignedBox3d& box, std::vector<int>& triangles) const;

  /// Square of the distance from `p` to the nearest triangle, m^2; `bound_squared` when none is nearer than that.
  double squaredDistance(const Vector3& p, double bound_squared) const;

  /// Root first, parents before children. Empty without triangles.
  const std::vector<Node>& nodes() const { return nodes_; }
  const Vector3* corners(int triangle) const { return &corners_[3 * static_cast<std::size_t>(triangle)]; }

 private:
  void placeCorners(const NodalVectors& x);
  void collect(int node, const Eigen::AlignedBox3d& box, std::vector<int>& triangles) const;
  void descend(int node, const Vector3& p, double& best) const;

  std::vector<Triangle> triangles_;
  std::vector<Vector3> corners_;  ///< three per triangle
  std::vector<Node> nodes_;
};

}  // namespace tissue_contact
