/// @file
/// Room `contact`, private: what preparing a mesh shape asks of its triangles: the nearest one, and how often they wind
/// around a point.
#pragma once

#include <cmath>
#include <vector>

#include "tissue_contact/core/types.h"
#include "tissue_contact/instrument/collision_shape.h"

namespace tissue_contact {

/// A binary tree of axis-aligned boxes over the triangles of a mesh. Const after construction, thread-safe.
class SurfaceTree {
 public:
  /// @param mesh must outlive the tree; at least one triangle, indices in range.
  explicit SurfaceTree(const TriangleMesh& mesh);

  /// Square of the distance from `p` to the nearest triangle, m^2; `bound_squared` when none is nearer than that.
  double squaredDistance(const Vector3& p, double bound_squared) const;

  /// Generalised winding number (Jacobson et al. 2013): the solid angle of the surface seen from `p` over 4 pi, 1 inside
  /// and 0 outside of a closed outward surface, and in between only near its holes. Triangles farther away than
  /// twice the extent of their box are summed as dipoles (Barill et al. 2018, first order).
  double windingNumber(const Vector3& p) const;

  /// Whether the surface winds around `p`, forwards or backwards. The middle of a hole and either side of a wall across
  /// the inside see half a turn less; walls are the likelier.
  bool isInside(const Vector3& p) const { return std::abs(windingNumber(p)) > 0.4; }

 private:
  struct Node {
    Eigen::AlignedBox3d box;
    Vector3 centre = Vector3::Zero();       ///< of the area
    Vector3 area_normal = Vector3::Zero();  ///< sum of normal times area, m^2
    double radius = 0.0;                    ///< of a ball at `centre` around the box, m
    int first = 0;                          ///< triangle of a leaf, else left child; the right child follows it
    int count = 0;                          ///< of triangles, 0: not a leaf
  };

  void build(int node, int begin, int end);
  void descend(int node, const Vector3& p, double& best) const;
  double solidAngle(int node, const Vector3& p) const;

  const TriangleMesh& mesh_;
  std::vector<int> order_;        ///< triangles in the order of the leaves
  std::vector<Vector3> corners_;  ///< three per triangle, in that order
  std::vector<Node> nodes_;
};

}  // namespace tissue_contact
