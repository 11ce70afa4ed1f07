#include "mesh/surface/triangle_tree.h"

#include <algorithm>
#include <numeric>
#include <utility>

namespace tissue_contact {
namespace {

constexpr int kLeafSize = 4;

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

}  // namespace

TriangleTree::TriangleTree(const NodalVectors& x, std::vector<Triangle> triangles)
    : triangles_(std::move(triangles)),
      order_(triangles_.size()),
      corners_(3 * triangles_.size()),
      boxes_(triangles_.size()) {
  if (triangles_.empty()) return;
  std::vector<Vector3> middles;
  middles.reserve(triangles_.size());
  for (const Triangle& t : triangles_) middles.emplace_back((x.col(t[0]) + x.col(t[1]) + x.col(t[2])) / 3.0);
  std::iota(order_.begin(), order_.end(), 0);
  nodes_.emplace_back();
  build(0, 0, static_cast<int>(order_.size()), middles);
  refit(x);
}

void TriangleTree::build(int node, int begin, int end, const std::vector<Vector3>& middles) {
  if (end - begin <= kLeafSize) {
    nodes_[node].first = begin;
    nodes_[node].count = end - begin;
    return;
  }
  Eigen::AlignedBox3d around;
  for (int i = begin; i < end; ++i) around.extend(middles[order_[i]]);
  int axis = 0;
  around.sizes().maxCoeff(&axis);
  const int half = begin + (end - begin) / 2;
  std::nth_element(order_.begin() + begin, order_.begin() + half, order_.begin() + end, [&](int s, int t) {
    return std::make_pair(middles[s][axis], s) < std::make_pair(middles[t][axis], t);
  });
  const int children = nodes_[node].first = static_cast<int>(nodes_.size());
  nodes_.resize(nodes_.size() + 2);
  build(children, begin, half, middles);
  build(children + 1, half, end, middles);
}

void TriangleTree::refit(const NodalVectors& x) {
  for (std::size_t i = 0; i < order_.size(); ++i) {
    Vector3* const c = &corners_[3 * i];
    for (std::size_t k = 0; k < 3; ++k) c[k] = x.col(triangles_[order_[i]][k]);
    boxes_[i] = Eigen::AlignedBox3d(c[0].cwiseMin(c[1]).cwiseMin(c[2]), c[0].cwiseMax(c[1]).cwiseMax(c[2]));
  }
  for (std::size_t n = nodes_.size(); n-- > 0;) {
    Node& node = nodes_[n];
    if (node.count == 0) {
      node.box = nodes_[node.first].box.merged(nodes_[node.first + 1].box);
      continue;
    }
    node.box = boxes_[node.first];
    for (int i = 1; i < node.count; ++i) node.box.extend(boxes_[node.first + i]);
  }
}

void TriangleTree::overlapping(const Eigen::AlignedBox3d& box, std::vector<int>& triangles) const {
  triangles.clear();
  if (nodes_.empty()) return;
  collect(0, box, triangles);
  std::sort(triangles.begin(), triangles.end());
}

void TriangleTree::collect(int node, const Eigen::AlignedBox3d& box, std::vector<int>& triangles) const {
  const Node& here = nodes_[node];
  if (!here.box.intersects(box)) return;
  for (int i = here.first; i < here.first + here.count; ++i) {
    if (box.intersects(boxes_[i])) triangles.push_back(order_[i]);
  }
  if (here.count > 0) return;
  collect(here.first, box, triangles);
  collect(here.first + 1, box, triangles);
}

double TriangleTree::squaredDistance(const Vector3& p, double bound_squared) const {
  double best = bound_squared;
  descend(0, p, best);
  return best;
}

void TriangleTree::descend(int node, const Vector3& p, double& best) const {
  const Node& here = nodes_[node];
  if (here.count > 0) {
    for (int i = here.first; i < here.first + here.count; ++i) {
      const Vector3* const c = corners(i);
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

}  // namespace tissue_contact
