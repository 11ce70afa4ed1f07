#include "mesh/surface/winding_tree.h"

namespace tissue_contact {
namespace {

constexpr double kFar = 2.0;  // in radii: the error of a dipole there is some 1e-3, signs need 0.5

/// Van Oosterom and Strackee 1983.
double solidAngleOfTriangle(const Vector3& a, const Vector3& b, const Vector3& c) {
  const double la = a.norm();
  const double lb = b.norm();
  const double lc = c.norm();
  const double triple = a.dot(b.cross(c));
  return 2.0 * std::atan2(triple, la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
}

}  // namespace

WindingTree::WindingTree(const TriangleMesh& mesh)
    : triangles_(mesh.vertices, mesh.triangles), dipoles_(triangles_.nodes().size()) {
  for (std::size_t n = dipoles_.size(); n-- > 0;) {
    const TriangleTree::Node& node = triangles_.nodes()[n];
    Dipole& made = dipoles_[n];
    Vector3 moment = Vector3::Zero();
    if (node.triangle >= 0) {
      const Vector3* const c = triangles_.corners(node.triangle);
      made.area_normal = 0.5 * (c[1] - c[0]).cross(c[2] - c[0]);
      made.area = made.area_normal.norm();
      moment = made.area * Vector3((c[0] + c[1] + c[2]) / 3.0);
    }
    for (int i = 0; node.triangle < 0 && i < 2; ++i) {
      const Dipole& child = dipoles_[node.children + i];
      made.area_normal += child.area_normal;
      made.area += child.area;
      moment += child.area * child.centre;
    }
    made.centre = made.area > 0.0 ? Vector3(moment / made.area) : node.box.center();
    made.radius = (made.centre - node.box.min()).cwiseMax(node.box.max() - made.centre).norm();
  }
}

template <typename Look>
double WindingTree::solidAngle(int node, const Vector3& p, const Look& look) const {
  look();
  const Dipole& dipole = dipoles_[node];
  const Vector3 way = dipole.centre - p;
  const double squared = way.squaredNorm();
  if (squared > kFar * kFar * dipole.radius * dipole.radius) {
    return dipole.area_normal.dot(way) / (squared * std::sqrt(squared));
  }
  const TriangleTree::Node& here = triangles_.nodes()[node];
  if (here.triangle < 0) return solidAngle(here.children, p, look) + solidAngle(here.children + 1, p, look);
  const Vector3* const c = triangles_.corners(here.triangle);
  return solidAngleOfTriangle(c[0] - p, c[1] - p, c[2] - p);
}

double WindingTree::solidAngle(int node, const Vector3& p) const {
  return solidAngle(node, p, [] {});
}

bool WindingTree::isInside(const Vector3& p, std::size_t& looks) const {
  return std::abs(solidAngle(0, p, [&looks] { ++looks; }) / (4.0 * M_PI)) > 0.4;
}

}  // namespace tissue_contact
