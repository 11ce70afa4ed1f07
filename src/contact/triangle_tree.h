/// @file
/// Room `contact`: a bounding-volume tree over triangles (FCL), refitted when they move.
#pragma once

#include <memory>
#include <vector>

#include "contact/triangle_geometry.h"
#include "tissue_contact/core/types.h"

namespace tissue_contact {

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

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace tissue_contact
