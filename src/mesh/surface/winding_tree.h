/// @file
/// Room `mesh`, private: how often a surface winds around a point, which tells inside from outside.
#pragma once

#include <cmath>
#include <cstddef>
#include <vector>

#include "mesh/surface/triangle_tree.h"
#include "tissue_contact/mesh/triangle_mesh.h"

namespace tissue_contact {

/// Const after construction, thread-safe.
class WindingTree {
 public:
  /// @param mesh at least one triangle, indices in range.
  explicit WindingTree(const TriangleMesh& mesh);

  /// Generalised winding number (Jacobson et al. 2013): the solid angle of the surface seen from `p` over 4 pi, 1 inside
  /// and 0 outside of a closed outward surface, and in between only near its holes. Triangles farther away than
  /// twice the extent of their box are summed as dipoles (Barill et al. 2018, first order).
  double windingNumber(const Vector3& p) const { return solidAngle(0, p) / (4.0 * M_PI); }

  /// Whether the surface winds around `p`, forwards or backwards. The middle of a hole and either side of a wall across
  /// the inside see half a turn less; walls are the likelier.
  bool isInside(const Vector3& p) const { return std::abs(windingNumber(p)) > 0.4; }

  /// The same, counting the boxes and triangles that were looked at: most of them, where a mesh passes through itself all over.
  bool isInside(const Vector3& p, std::size_t& looks) const;

  const TriangleTree& triangles() const { return triangles_; }

 private:
  struct Dipole {
    Vector3 centre = Vector3::Zero();       ///< of the area
    Vector3 area_normal = Vector3::Zero();  ///< sum of normal times area, m^2
    double area = 0.0;                      ///< m^2
    double radius = 0.0;                    ///< of a ball at `centre` around the box, m
  };

  double solidAngle(int node, const Vector3& p) const;
  template <typename Look>
  double solidAngle(int node, const Vector3& p, const Look& look) const;

  TriangleTree triangles_;
  std::vector<Dipole> dipoles_;  ///< per node
};

}  // namespace tissue_contact
