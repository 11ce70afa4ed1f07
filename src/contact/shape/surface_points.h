/// @file
/// Room `contact`, private: points spread over the surface of a mesh (start-up only).
#pragma once

#include <cmath>

#include "mesh/surface/triangle_geometry.h"
#include "tissue_contact/mesh/triangle_mesh.h"

namespace tissue_contact {

/// Points spread evenly over the triangles (additive recurrence of the plastic number, folded into each triangle).
/// @param points about how many; each triangle has one at least.
/// @param visit gets a point, its share of the area and the triangle.
template <typename Visit>
void eachPoint(const TriangleMesh& mesh, double points, const Visit& visit) {
  const auto corner = [&](const Triangle& t, int k) -> Vector3 { return mesh.vertices.col(t[k]); };
  double total = 0.0;
  for (const Triangle& t : mesh.triangles) total += triangleArea(mesh.vertices, t);
  double u = 0.5;
  double v = 0.5;
  for (const Triangle& t : mesh.triangles) {
    const double share = triangleArea(mesh.vertices, t) / total;
    const int count = static_cast<int>(std::ceil(points * share));
    for (int i = 0; i < count; ++i) {
      u = std::fmod(u + 0.7548776662466927, 1.0);
      v = std::fmod(v + 0.5698402909980532, 1.0);
      const bool fold = u + v > 1.0;
      const double a = fold ? 1.0 - u : u;
      const double b = fold ? 1.0 - v : v;
      visit(corner(t, 0) + a * (corner(t, 1) - corner(t, 0)) + b * (corner(t, 2) - corner(t, 0)), share / count, t);
    }
  }
}

}  // namespace tissue_contact
