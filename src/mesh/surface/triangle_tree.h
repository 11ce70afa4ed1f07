/// @file
/// Room `mesh`, private: a binary tree of axis-aligned boxes over triangles.
///
/// Split at the median of the triangles' middles along the axis on which these are spread most, down to leaves of four,
/// whose corners lie side by side. When the triangles move, the boxes are refitted and the structure stays.
/// Not FCL's: of its BVHModel only the construction was of use. Its traversals test triangle against triangle and run a
/// narrow phase at every leaf, where here a box (a shape's, or that around a vertex) asks for the triangles near it; and
/// its collision managers sort many bodies, of which a scene has a few.
#pragma once

#include <vector>

#include "tissue_contact/core/types.h"

namespace tissue_contact {

class TriangleTree {
 public:
  struct Node {
    Eigen::AlignedBox3d box;
    int first = 0;  ///< place of a leaf's first triangle, else left child; the right child follows it
    int count = 0;  ///< of triangles, 0: not a leaf
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
  /// The three corners of the triangle at a place.
  const Vector3* corners(int place) const { return &corners_[3 * static_cast<std::size_t>(place)]; }

 private:
  void build(int node, int begin, int end, const std::vector<Vector3>& middles);
  void collect(int node, const Eigen::AlignedBox3d& box, std::vector<int>& triangles) const;
  void descend(int node, const Vector3& p, double& best) const;

  std::vector<Triangle> triangles_;
  std::vector<int> order_;                  ///< triangles by place
  std::vector<Vector3> corners_;            ///< three per triangle, by place
  std::vector<Eigen::AlignedBox3d> boxes_;  ///< of each triangle, by place
  std::vector<Node> nodes_;
};

}  // namespace tissue_contact
