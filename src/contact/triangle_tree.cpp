#include "contact/triangle_tree.h"

// First: BVH_model.h uses fit() without declaring it.
#include <fcl/geometry/bvh/BVH_model.h>
#include <fcl/math/bv/utility.h>

#include <algorithm>
#include <limits>
#include <utility>

namespace tissue_contact {
namespace {

using Tree = fcl::BVHModel<fcl::AABBd>;

double squaredDistance(const fcl::AABBd& box, const Vector3& p) {
  return (box.min_ - p).cwiseMax(p - box.max_).cwiseMax(0.0).squaredNorm();
}

/// Visits the tree's triangles near one triangle.
class NearVisitor {
 public:
  NearVisitor(const Tree& tree, const TrianglePoints& triangle, const double& reach,
              const std::function<void(int)>& visit)
      : tree_(tree), triangle_(triangle), reach_(reach), visit_(visit) {
    for (const Vector3& corner : triangle.corners) box_.extend(corner);
  }

  void descend(int node_index) const {
    const fcl::BVNode<fcl::AABBd>& node = tree_.getBV(node_index);
    if (node.isLeaf()) {
      visit_(node.primitiveId());
      return;
    }
    int near = node.leftChild();
    int far = node.rightChild();
    double to_near = lowerBound(tree_.getBV(near).bv);
    double to_far = lowerBound(tree_.getBV(far).bv);
    if (to_far < to_near) {
      std::swap(near, far);
      std::swap(to_near, to_far);
    }
    if (to_near <= reach_) descend(near);
    if (to_far <= reach_) descend(far);
  }

 private:
  /// A box is no nearer to the triangle than to its bounding box and to its plane.
  double lowerBound(const fcl::AABBd& box) const {
    const double apart = (box.min_ - box_.max()).cwiseMax(box_.min() - box.max_).cwiseMax(0.0).norm();
    const Vector3 to_centre = 0.5 * (box.min_ + box.max_) - triangle_.corners[0];
    const double half = 0.5 * triangle_.normal.cwiseAbs().dot(box.max_ - box.min_);
    return std::max(apart, std::abs(triangle_.normal.dot(to_centre)) - half);
  }

  const Tree& tree_;
  const TrianglePoints& triangle_;
  const double& reach_;
  const std::function<void(int)>& visit_;
  Eigen::AlignedBox3d box_;
};

/// FCL's own tests are calls into its library, which take most of the time of a descent.
bool overlap(const fcl::AABBd& a, const Eigen::AlignedBox3d& b) {
  return a.min_.x() <= b.max().x() && b.min().x() <= a.max_.x() && a.min_.y() <= b.max().y() &&
         b.min().y() <= a.max_.y() && a.min_.z() <= b.max().z() && b.min().z() <= a.max_.z();
}

void collectOverlapping(const fcl::BVNode<fcl::AABBd>* nodes, int node_index, const Eigen::AlignedBox3d& box,
                        std::vector<int>& triangles) {
  const fcl::BVNode<fcl::AABBd>& node = nodes[node_index];
  if (!overlap(node.bv, box)) return;
  const int child = node.first_child;
  if (child < 0) {
    triangles.push_back(-child - 1);
    return;
  }
  collectOverlapping(nodes, child, box, triangles);
  collectOverlapping(nodes, child + 1, box, triangles);
}

void findNearest(const Tree& tree, int node_index, const Vector3& p, NearestOnTriangles& best) {
  const fcl::BVNode<fcl::AABBd>& node = tree.getBV(node_index);
  if (node.isLeaf()) {
    const fcl::Triangle& nodes = tree.tri_indices[node.primitiveId()];
    const std::array<Vector3, 3> corners = {tree.vertices[nodes[0]], tree.vertices[nodes[1]], tree.vertices[nodes[2]]};
    const Vector3 weights = projectOnTriangle(corners, p);
    const Vector3 point = weights[0] * corners[0] + weights[1] * corners[1] + weights[2] * corners[2];
    const double squared = (point - p).squaredNorm();
    if (squared < best.distance_squared) best = {node.primitiveId(), weights, point, squared};
    return;
  }
  int near = node.leftChild();
  int far = node.rightChild();
  double near_squared = squaredDistance(tree.getBV(near).bv, p);
  double far_squared = squaredDistance(tree.getBV(far).bv, p);
  if (far_squared < near_squared) {
    std::swap(near, far);
    std::swap(near_squared, far_squared);
  }
  if (near_squared < best.distance_squared) findNearest(tree, near, p, best);
  if (far_squared < best.distance_squared) findNearest(tree, far, p, best);
}

}  // namespace

struct TriangleTree::Implementation {
  Tree tree;
  std::vector<int> nodes;  // the node of each of the tree's vertices: those that triangles use
};

TriangleTree::TriangleTree(const NodalVectors& positions, std::vector<Triangle> triangles)
    : implementation_(std::make_unique<Implementation>()) {
  if (triangles.empty()) return;
  Implementation& self = *implementation_;
  std::vector<int> vertex_of_node(positions.cols(), -1);
  std::vector<fcl::Triangle> fcl_triangles;
  std::vector<Vector3> vertices;
  for (Triangle& triangle : triangles) {
    for (int& node : triangle) {
      if (vertex_of_node[node] < 0) {
        vertex_of_node[node] = static_cast<int>(vertices.size());
        self.nodes.push_back(node);
        vertices.emplace_back(positions.col(node));
      }
      node = vertex_of_node[node];
    }
    fcl_triangles.emplace_back(triangle[0], triangle[1], triangle[2]);
  }
  self.tree.beginModel(static_cast<int>(fcl_triangles.size()), static_cast<int>(vertices.size()));
  self.tree.addSubModel(vertices, fcl_triangles);
  self.tree.endModel();
}

TriangleTree::~TriangleTree() = default;
TriangleTree::TriangleTree(TriangleTree&&) noexcept = default;
TriangleTree& TriangleTree::operator=(TriangleTree&&) noexcept = default;

void TriangleTree::refit(const NodalVectors& positions) {
  Implementation& self = *implementation_;
  if (self.nodes.empty()) return;
  // Children come after their parent, so one pass from the back refits bottom-up. FCL's own refit (beginReplaceModel
  // ... endReplaceModel) gives the same boxes by recursion in 28 us for 720 triangles; this takes 12 us.
  Tree& tree = self.tree;
  for (std::size_t i = 0; i < self.nodes.size(); ++i) tree.vertices[i] = positions.col(self.nodes[i]);
  for (int i = tree.getNumBVs() - 1; i >= 0; --i) {
    fcl::BVNode<fcl::AABBd>& node = tree.getBV(i);
    if (node.isLeaf()) {
      const fcl::Triangle& corners = tree.tri_indices[node.primitiveId()];
      const Vector3& a = tree.vertices[corners[0]];
      const Vector3& b = tree.vertices[corners[1]];
      const Vector3& c = tree.vertices[corners[2]];
      node.bv.min_ = a.cwiseMin(b).cwiseMin(c);
      node.bv.max_ = a.cwiseMax(b).cwiseMax(c);
    } else {
      const fcl::AABBd& left = tree.getBV(node.leftChild()).bv;
      const fcl::AABBd& right = tree.getBV(node.rightChild()).bv;
      node.bv.min_ = left.min_.cwiseMin(right.min_);
      node.bv.max_ = left.max_.cwiseMax(right.max_);
    }
  }
}

void TriangleTree::overlapping(const Eigen::AlignedBox3d& box, std::vector<int>& triangles) const {
  triangles.clear();
  if (implementation_->nodes.empty()) return;
  collectOverlapping(&implementation_->tree.getBV(0), 0, box, triangles);
  std::sort(triangles.begin(), triangles.end());
}

void TriangleTree::visitNear(const TrianglePoints& triangle, const double& reach,
                             const std::function<void(int)>& visit) const {
  if (!implementation_->nodes.empty()) NearVisitor(implementation_->tree, triangle, reach, visit).descend(0);
}

NearestOnTriangles TriangleTree::nearest(const Vector3& p) const {
  NearestOnTriangles best;
  best.distance_squared = std::numeric_limits<double>::infinity();
  if (!implementation_->nodes.empty()) findNearest(implementation_->tree, 0, p, best);
  return best;
}

}  // namespace tissue_contact
