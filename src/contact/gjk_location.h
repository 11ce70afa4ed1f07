/// @file
/// Room `contact`: FCL's GJK between a cylinder and a triangle that do not touch: where on the triangle they are
/// nearest.
#pragma once

#include <array>
#include <memory>

#include "tissue_contact/core/types.h"

namespace tissue_contact {

/// Const after construction. The cylinder is scaled to unit size inside, because FCL's tolerances are absolute.
class GjkLocation {
 public:
  /// Axis along z, m.
  GjkLocation(double radius, double half_length);
  ~GjkLocation();
  GjkLocation(GjkLocation&&) noexcept;
  GjkLocation& operator=(GjkLocation&&) noexcept;

  /// @param corners of the triangle, in the cylinder's frame, m. @param point on the triangle (m), to about 1e-6 of the
  ///   size where the distance is curved; the distance there is right to 1e-12.
  /// @returns false when they touch or GJK does not converge.
  bool nearest(const std::array<Vector3, 3>& corners, Vector3& point) const;

 private:
  struct Implementation;
  std::unique_ptr<Implementation> implementation_;
};

}  // namespace tissue_contact
