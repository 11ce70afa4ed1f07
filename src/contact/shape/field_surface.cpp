#include "contact/shape/field_surface.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include "mesh/nodes.h"

namespace tissue_contact {
namespace {

struct Corner {
  Vector3 point;
  double value;
};

/// Six tetrahedra of a cube around its diagonal 0-7; bit a of a corner's index is its place along axis a.
constexpr std::array<std::array<int, 4>, 6> kTetrahedra = {
    {{0, 1, 3, 7}, {0, 3, 2, 7}, {0, 2, 6, 7}, {0, 6, 4, 7}, {0, 4, 5, 7}, {0, 5, 1, 7}}};

class Marcher {
 public:
  void addTetrahedron(const std::array<Corner, 4>& corners) {
    std::array<Corner, 4> in;
    std::array<Corner, 4> out;
    int inside = 0;
    int outside = 0;
    for (const Corner& corner : corners) (corner.value < 0.0 ? in[inside++] : out[outside++]) = corner;
    if (inside == 0 || outside == 0) return;
    const Vector3 outward = out[0].point - in[0].point;
    if (inside == 1) add(between(in[0], out[0]), between(in[0], out[1]), between(in[0], out[2]), outward);
    if (outside == 1) add(between(in[0], out[0]), between(in[1], out[0]), between(in[2], out[0]), outward);
    if (inside == 2) {
      const Vector3 a = between(in[0], out[0]);
      const Vector3 b = between(in[0], out[1]);
      const Vector3 c = between(in[1], out[1]);
      const Vector3 d = between(in[1], out[0]);
      const Vector3 way = out[0].point + out[1].point - in[0].point - in[1].point;
      add(a, b, c, way);
      add(a, c, d, way);
    }
  }

  std::size_t count() const { return points_.size() / 3; }

  TriangleMesh mesh() const { return separateTriangles(points_); }

 private:
  static Vector3 between(const Corner& in, const Corner& out) {
    return in.point + in.value / (in.value - out.value) * (out.point - in.point);
  }
  void add(const Vector3& a, const Vector3& b, const Vector3& c, const Vector3& outward) {
    const bool turned = (b - a).cross(c - a).dot(outward) < 0.0;
    points_.push_back(a);
    points_.push_back(turned ? c : b);
    points_.push_back(turned ? b : c);
  }

  std::vector<Vector3> points_;
};

Marcher march(const DistanceGrid& grid, double cell) {
  const Eigen::AlignedBox3d box = grid.box();
  std::array<int, 3> count{};
  for (int a = 0; a < 3; ++a) count[a] = std::max(1, static_cast<int>(std::ceil(box.sizes()[a] / cell)));
  const auto corner = [&](int i, int j, int k) -> Corner {
    const Vector3 share(static_cast<double>(i) / count[0], static_cast<double>(j) / count[1],
                        static_cast<double>(k) / count[2]);
    const Vector3 p = box.min() + share.cwiseProduct(box.sizes());
    return {p, grid.at(p).distance};
  };
  const double reach = 2.0 * cell;
  Marcher marcher;
  for (int k = 0; k < count[2]; ++k) {
    for (int j = 0; j < count[1]; ++j) {
      for (int i = 0; i < count[0]; ++i) {
        std::array<Corner, 8> cube;
        cube[0] = corner(i, j, k);
        if (std::abs(cube[0].value) > reach) continue;
        for (int c = 1; c < 8; ++c) cube[c] = corner(i + (c & 1), j + ((c >> 1) & 1), k + ((c >> 2) & 1));
        for (const auto& t : kTetrahedra) marcher.addTetrahedron({cube[t[0]], cube[t[1]], cube[t[2]], cube[t[3]]});
      }
    }
  }
  return marcher;
}

}  // namespace

TriangleMesh fieldSurface(const DistanceGrid& grid, std::size_t most_triangles) {
  double cell = std::max(2.0 * grid.spacing, grid.box().sizes().maxCoeff() / 100.0);
  Marcher marcher = march(grid, cell);
  while (marcher.count() > most_triangles) {
    cell *= 1.25;
    marcher = march(grid, cell);
  }
  return marcher.mesh();
}

}  // namespace tissue_contact
