#include "contact/surface_tree.h"

#include <algorithm>
#include <cmath>
#include <utility>

namespace tissue_contact {
namespace {

constexpr int kLeafSize = 4;
constexpr double kFar = 2.0;  // in radii: the error of a dipole there is some 1e-3, signs need 0.5

double squaredDistanceToBox(const Eigen::AlignedBox3d& box, const Vector3& p) {
  return (box.min() - p).cwiseMax(p - box.max()).cwiseMax(0.0).squaredNorm();
}

/// By the regions of the plane in which a vertex, an edge or the inside is nearest.
double squaredDistanceToTriangle(const Vector3& a, const Vector3& b, const Vector3& c, const Vector3& p) {
  const Vector3 ab = b - a;
  const Vector3 ac = c - a;
  const Vector3 ap = p - a;
  const Vector3 normal = ab.cross(ac);
  const double twice_area_squared = normal.squaredNorm();
  const double beyond_ab = normal.cross(ab).dot(ap);
  const double beyond_ac = ac.cross(normal).dot(ap);
  const Vector3 bc = c - b;
  const double beyond_bc = normal.cross(bc).dot(p - b);
  if (beyond_ab >= 0.0 && beyond_ac >= 0.0 && beyond_bc >= 0.0 && twice_area_squared > 0.0) {
    const double along = normal.dot(ap);
    return along * along / twice_area_squared;
  }
  const auto toSegment = [&](const Vector3& from, const Vector3& way) {
    const Vector3 offset = p - from;
    const double length_squared = way.squaredNorm();
    const double u = length_squared > 0.0 ? std::clamp(offset.dot(way) / length_squared, 0.0, 1.0) : 0.0;
    return (offset - u * way).squaredNorm();
  };
  return std::min({toSegment(a, ab), toSegment(a, ac), toSegment(b, bc)});
}

/// Van Oosterom and Strackee 1983.
double solidAngleOfTriangle(const Vector3& a, const Vector3& b, const Vector3& c) {
  const double la = a.norm();
  const double lb = b.norm();
  const double lc = c.norm();
  const double triple = a.dot(b.cross(c));
  return 2.0 * std::atan2(triple, la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
}

}  // namespace

SurfaceTree::SurfaceTree(const TriangleMesh& mesh) : mesh_(mesh) {
  const int count = static_cast<int>(mesh.triangles.size());
  order_.resize(count);
  for (int i = 0; i < count; ++i) order_[i] = i;
  nodes_.emplace_back();
  build(0, 0, count);
  for (const int triangle : order_) {
    for (const int v : mesh.triangles[triangle]) corners_.emplace_back(mesh.vertices.col(v));
  }
}

void SurfaceTree::build(int node, int begin, int end) {
  Node made;
  Eigen::AlignedBox3d middles;
  Vector3 moment = Vector3::Zero();
  double area = 0.0;
  const auto corner = [&](int triangle, int k) -> Vector3 { return mesh_.vertices.col(mesh_.triangles[triangle][k]); };
  const auto middle = [&](int triangle) -> Vector3 {
    return (corner(triangle, 0) + corner(triangle, 1) + corner(triangle, 2)) / 3.0;
  };
  for (int i = begin; i < end; ++i) {
    const int t = order_[i];
    for (int k = 0; k < 3; ++k) made.box.extend(corner(t, k));
    const Vector3 normal = 0.5 * (corner(t, 1) - corner(t, 0)).cross(corner(t, 2) - corner(t, 0));
    middles.extend(middle(t));
    made.area_normal += normal;
    moment += normal.norm() * middle(t);
    area += normal.norm();
  }
  made.centre = area > 0.0 ? Vector3(moment / area) : made.box.center();
  made.radius = (made.centre - made.box.min()).cwiseMax(made.box.max() - made.centre).norm();
  if (end - begin <= kLeafSize) {
    made.first = begin;
    made.count = end - begin;
    nodes_[node] = made;
    return;
  }
  int axis = 0;
  middles.sizes().maxCoeff(&axis);
  const int half = begin + (end - begin) / 2;
  std::nth_element(order_.begin() + begin, order_.begin() + half, order_.begin() + end, [&](int s, int t) {
    return std::make_pair(middle(s)[axis], s) < std::make_pair(middle(t)[axis], t);
  });
  made.first = static_cast<int>(nodes_.size());
  nodes_[node] = made;
  nodes_.resize(nodes_.size() + 2);
  build(made.first, begin, half);
  build(made.first + 1, half, end);
}

double SurfaceTree::squaredDistance(const Vector3& p, double bound_squared) const {
  double best = bound_squared;
  descend(0, p, best);
  return best;
}

void SurfaceTree::descend(int node, const Vector3& p, double& best) const {
  const Node& here = nodes_[node];
  if (here.count > 0) {
    for (int i = here.first; i < here.first + here.count; ++i) {
      const Vector3* c = &corners_[3 * static_cast<std::size_t>(i)];
      best = std::min(best, squaredDistanceToTriangle(c[0], c[1], c[2], p));
    }
    return;
  }
  int near = here.first;
  int far = here.first + 1;
  double to_near = squaredDistanceToBox(nodes_[near].box, p);
  double to_far = squaredDistanceToBox(nodes_[far].box, p);
  if (to_far < to_near) {
    std::swap(near, far);
    std::swap(to_near, to_far);
  }
  if (to_near < best) descend(near, p, best);
  if (to_far < best) descend(far, p, best);
}

double SurfaceTree::windingNumber(const Vector3& p) const { return solidAngle(0, p) / (4.0 * M_PI); }

double SurfaceTree::solidAngle(int node, const Vector3& p) const {
  const Node& here = nodes_[node];
  const Vector3 way = here.centre - p;
  const double squared = way.squaredNorm();
  if (squared > kFar * kFar * here.radius * here.radius)
    return here.area_normal.dot(way) / (squared * std::sqrt(squared));
  if (here.count == 0) return solidAngle(here.first, p) + solidAngle(here.first + 1, p);
  double sum = 0.0;
  for (int i = here.first; i < here.first + here.count; ++i) {
    const Vector3* c = &corners_[3 * static_cast<std::size_t>(i)];
    sum += solidAngleOfTriangle(c[0] - p, c[1] - p, c[2] - p);
  }
  return sum;
}

}  // namespace tissue_contact
