#include "contact/gjk_location.h"

#include <fcl/geometry/shape/cylinder.h>
#include <fcl/narrowphase/detail/gjk_solver_indep.h>

#include <algorithm>

namespace tissue_contact {

struct GjkLocation::Implementation {
  double size;  // m
  fcl::Cylinderd unit_cylinder;
  fcl::detail::GJKSolver_indep<double> solver;

  Implementation(double radius, double half_length)
      : size(std::min(radius, half_length)), unit_cylinder(radius / size, 2.0 * half_length / size) {
    // FCL compares squared lengths with this too, so 1e-12 resolves 1e-6 along a curved surface.
    solver.gjk_tolerance = 1e-12;
    solver.gjk_max_iterations = 128;
  }
};

GjkLocation::GjkLocation(double radius, double half_length)
    : implementation_(std::make_unique<Implementation>(radius, half_length)) {}
GjkLocation::~GjkLocation() = default;
GjkLocation::GjkLocation(GjkLocation&&) noexcept = default;
GjkLocation& GjkLocation::operator=(GjkLocation&&) noexcept = default;

bool GjkLocation::nearest(const std::array<Vector3, 3>& corners, Vector3& point) const {
  const Implementation& self = *implementation_;
  const Vector3 a = corners[0] / self.size;
  const Vector3 b = corners[1] / self.size;
  const Vector3 c = corners[2] / self.size;
  double distance = 0.0;
  Vector3 on_cylinder;
  Vector3 on_triangle;
  const bool apart = self.solver.shapeTriangleDistance(self.unit_cylinder, fcl::Transform3d::Identity(), a, b, c,
                                                       &distance, &on_cylinder, &on_triangle);
  point = self.size * on_triangle;
  return apart;
}

}  // namespace tissue_contact
