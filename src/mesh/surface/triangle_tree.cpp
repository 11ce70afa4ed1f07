#include "mesh/surface/triangle_tree.h"

#if __has_include(<fcl/geometry/bvh/BVH_model.h>)
// utility.h declares the fit() that BVH_model.h uses.
#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/math/bv/utility.h>
#else  // FCL 0.5: Ubuntu 20.04
#include <fcl/BVH/BVH_model.h>
#endif

#include <algorithm>
#include <memory>
#include <new>
#include <utility>

namespace tissue_contact {
namespace {

#if __has_include(<fcl/geometry/bvh/BVH_model.h>)
using FclTree = fcl::BVHModel<fcl::AABBd>;
using FclPoint = fcl::Vector3d;
#else
using FclTree = fcl::BVHModel<fcl::AABB>;
using FclPoint = fcl::Vec3f;
#endif

std::unique_ptr<FclTree> buildTree(const std::vector<Vector3>& corners) {
  std::vector<FclPoint> vertices;
  std::vector<fcl::Triangle> triangles;
  vertices.reserve(corners.size());
  triangles.reserve(corners.size() / 3);
  for (const Vector3& p : corners) vertices.emplace_back(p[0], p[1], p[2]);
  for (std::size_t k = 0; k < corners.size(); k += 3) triangles.emplace_back(k, k + 1, k + 2);
  auto tree = std::make_unique<FclTree>();
  const bool built = tree->beginModel(static_cast<int>(triangles.size()), static_cast<int>(vertices.size())) == 0 &&
                     tree->addSubModel(vertices, triangles) == 0 && tree->endModel() == 0;
  if (!built) throw std::bad_alloc();  // it has no other reason with triangles of three vertices
  return tree;
}

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
    : triangles_(std::move(triangles)), corners_(3 * triangles_.size()) {
  if (triangles_.empty()) return;
  placeCorners(x);
  const std::unique_ptr<FclTree> built = buildTree(corners_);
  nodes_.reserve(static_cast<std::size_t>(built->getNumBVs()));
  for (int n = 0; n < built->getNumBVs(); ++n) {
    const auto& node = built->getBV(n);
    nodes_.emplace_back();
    if (node.isLeaf()) {
      nodes_.back().triangle = node.primitiveId();
    } else {
      nodes_.back().children = node.leftChild();
    }
  }
  refit(x);
}

void TriangleTree::placeCorners(const NodalVectors& x) {
  Vector3* corner = corners_.data();
  for (const Triangle& triangle : triangles_) {
    for (const int node : triangle) *corner++ = x.col(node);
  }
}

void TriangleTree::refit(const NodalVectors& x) {
  placeCorners(x);
  for (std::size_t n = nodes_.size(); n-- > 0;) {
    Node& node = nodes_[n];
    if (node.triangle < 0) {
      node.box = nodes_[node.children].box.merged(nodes_[node.children + 1].box);
    } else {
      const Vector3* const c = corners(node.triangle);
      node.box = Eigen::AlignedBox3d(c[0].cwiseMin(c[1]).cwiseMin(c[2]), c[0].cwiseMax(c[1]).cwiseMax(c[2]));
    }
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
  if (here.triangle >= 0) {
    triangles.push_back(here.triangle);
    return;
  }
  collect(here.children, box, triangles);
  collect(here.children + 1, box, triangles);
}

double TriangleTree::squaredDistance(const Vector3& p, double bound_squared) const {
  double best = bound_squared;
  descend(0, p, best);
  return best;
}

void TriangleTree::descend(int node, const Vector3& p, double& best) const {
  const Node& here = nodes_[node];
  if (here.triangle >= 0) {
    const Vector3* const c = corners(here.triangle);
    best = std::min(best, squaredDistanceToTriangle(c[0], c[1], c[2], p));
    return;
  }
  int near = here.children;
  int far = here.children + 1;
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
