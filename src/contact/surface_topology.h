/// @file
/// Room `contact`: which triangles of a tissue surface meet at a vertex, an edge or a face.
#pragma once

#include <array>
#include <vector>

#include "tissue_contact/core/types.h"

namespace tissue_contact {

/// A vertex (a, -1, -1), an edge (a, b, -1) or a face (a, b, c): sorted node indices, as in ContactKey.
using SurfaceFeature = std::array<int, 3>;

/// @throws std::invalid_argument unless there is one flag per node.
void requireOneFlagPerNode(const std::vector<bool>& fixed, int node_count);

/// Const after construction.
class SurfaceTopology {
 public:
  /// @throws std::invalid_argument when a triangle refers to a node outside [0, node_count) or twice to the same.
  SurfaceTopology(std::vector<Triangle> triangles, int node_count);

  const std::vector<Triangle>& triangles() const { return triangles_; }

  /// The feature that the corners of non-zero weight make up.
  SurfaceFeature featureOf(int triangle, const Vector3& weights) const;

  /// Calls `visit(triangle)` for the triangles that contain the feature, ascending, until it returns true.
  /// @returns whether it did.
  template <typename Visitor>
  bool anyTriangleOf(const SurfaceFeature& feature, const Visitor& visit) const {
    for (int i = fan_start_[feature[0]]; i < fan_start_[feature[0] + 1]; ++i) {
      if (contains(fan_[i], feature) && visit(fan_[i])) return true;
    }
    return false;
  }

 private:
  bool contains(int triangle, const SurfaceFeature& feature) const;

  std::vector<Triangle> triangles_;
  std::vector<int> fan_start_;  ///< per node, into fan_; one more entry than nodes
  std::vector<int> fan_;        ///< triangles around each node, ascending
};

}  // namespace tissue_contact
