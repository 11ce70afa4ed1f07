#include "mesh/surface/moving_surface.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <stdexcept>
#include <string>
#include <utility>

#include "mesh/mesh_checks.h"
#include "mesh/surface/triangle_geometry.h"
#include "tissue_contact/core/check.h"

namespace tissue_contact {
namespace {

constexpr double kLeastMoving = 0.25;  // of a point that is not held

/// The triangles, once all is known to be well.
std::vector<Triangle> checked(TissueSurface& surface, const NodalVectors& rest) {
  requireCount("tissue surface: fixed flags of nodes", surface.fixed.size(), rest.cols());
  for (std::size_t i = 0; i < surface.triangles.size(); ++i) {
    const Triangle& t = surface.triangles[i];
    checkNodeIndices(t, i, rest.cols(), "triangle", "tissue surface");
    if (t[0] != t[1] && t[1] != t[2] && t[2] != t[0]) continue;
    refuseMesh("tissue surface",
               indexed("triangle", i) + " refers to the same node twice; its three nodes must differ");
  }
  return std::move(surface.triangles);
}

}  // namespace

SharedSurfaces shareSurfaces(std::vector<TissueSurface> surfaces, const std::vector<NodalVectors>& rest) {
  requireCount("positions at rest of tissues", rest.size(), surfaces.size());
  auto shared = std::make_shared<std::vector<MovingSurface>>();
  for (std::size_t i = 0; i < surfaces.size(); ++i) {
    shared->emplace_back(static_cast<int>(i), std::move(surfaces[i]), rest[i]);
  }
  return shared;
}

void placeAll(std::vector<MovingSurface>& surfaces, const std::vector<NodalVectors>& positions) {
  requireCount("positions of tissues", positions.size(), surfaces.size());
  for (std::size_t i = 0; i < surfaces.size(); ++i) surfaces[i].place(positions[i]);
}

MovingSurface::MovingSurface(int tissue, TissueSurface surface, const NodalVectors& rest)
    : tissue_(tissue),
      rest_(rest),
      triangles_(checked(surface, rest)),
      fixed_(std::move(surface.fixed)),
      half_thickness_(0.5 * requireNonNegative("tissue surface: thickness", surface.thickness_m, "m")),
      edges_(triangles_),
      tree_(rest, triangles_),
      normals_(triangles_.size()) {
  findFans();
  measureAtRest();
  fit(rest);
}

void MovingSurface::findFans() {
  fan_start_.assign(nodeCount() + 1, 0);
  for (const Triangle& triangle : triangles_) {
    for (const int node : triangle) ++fan_start_[node + 1];
  }
  for (int node = 0; node < nodeCount(); ++node) {
    if (fan_start_[node + 1] > 0) nodes_.push_back(node);
    fan_start_[node + 1] += fan_start_[node];
  }
  fan_.resize(3 * triangles_.size());
  std::vector<int> next(fan_start_.begin(), fan_start_.end() - 1);
  for (std::size_t t = 0; t < triangles_.size(); ++t) {
    for (const int node : triangles_[t]) fan_[next[node]++] = static_cast<int>(t);
  }
}

void MovingSurface::measureAtRest() {
  longest_edge_.assign(nodeCount(), 0.0);
  double sum = 0.0;
  for (int t = 0; t < static_cast<int>(triangles_.size()); ++t) {
    for (const int i : edges_.edgesOf(t)) {
      const EdgeTable::Edge& edge = edges_[i];
      if (edges_.usesOf(edge)[0].triangle != t) continue;
      const double length = (rest_.col(edge.nodes[0]) - rest_.col(edge.nodes[1])).norm();
      sum += length;
      for (const int node : edge.nodes) longest_edge_[node] = std::max(longest_edge_[node], length);
    }
  }
  if (edges_.size() > 0) mean_edge_ = sum / static_cast<double>(edges_.size());
  Eigen::AlignedBox3d box;
  for (const int node : nodes_) box.extend(Vector3(rest_.col(node)));
  if (isVolume() && !nodes_.empty()) smallest_extent_ = box.sizes().minCoeff();
}

bool MovingSurface::isHeld(const Triangle& nodes, const Vector3& weights) const {
  constexpr double kRounding = 1e-9;
  double moving = 0.0;
  for (int i = 0; i < 3; ++i) {
    if (weights[i] != 0.0 && !fixed_[nodes[i]]) moving += weights[i];
  }
  return moving < (1.0 - kRounding) * kLeastMoving;
}

bool MovingSurface::findHeldLine(int triangle, Matrix3& corners) const {
  const Triangle& nodes = triangles_[triangle];
  int ends = 1;
  for (int i = 0; i < 3; ++i) {
    if (fixed_[nodes[i]]) continue;
    corners.col(0) = Vector3::Unit(i);
    for (int k = 0; k < 3; ++k) {
      if (fixed_[nodes[k]])
        corners.col(ends++) = kLeastMoving * Vector3::Unit(i) + (1.0 - kLeastMoving) * Vector3::Unit(k);
    }
  }
  return ends == 3;  // of one fixed node and two others, or of two and one
}

SurfaceFeature MovingSurface::featureOf(int triangle, const Vector3& weights) const {
  SurfaceFeature feature;
  for (int i = 0; i < 3; ++i) feature[i] = weights[i] > 0.0 ? triangles_[triangle][i] : -1;
  const auto order = [&](int i, int j) {  // -1 last
    if (static_cast<unsigned>(feature[j]) < static_cast<unsigned>(feature[i])) std::swap(feature[i], feature[j]);
  };
  order(0, 1);
  order(1, 2);
  order(0, 1);
  return feature;
}

bool MovingSurface::contains(int triangle, const SurfaceFeature& feature) const {
  const Triangle& nodes = triangles_[triangle];
  const auto has = [&](int node) { return node < 0 || node == nodes[0] || node == nodes[1] || node == nodes[2]; };
  return has(feature[1]) && has(feature[2]);
}

void MovingSurface::place(const NodalVectors& positions) {
  requireCount("positions of nodes of a tissue", positions.cols(), rest_.cols());
  const std::size_t bytes = static_cast<std::size_t>(positions.size()) * sizeof(double);
  if (placed_ > 0 && bytes > 0 && std::memcmp(positions.data(), x_.data(), bytes) == 0) return;
  x_ = positions;
  ++placed_;
  box_.setEmpty();
  for (const int node : nodes_) box_.extend(x(node));
}

void MovingSurface::fit(const NodalVectors& positions) {
  place(positions);
  fit();
}

void MovingSurface::fit() {
  tree_.refit(x_);
  fitted_.clear();
  for (const int node : nodes_) fitted_.push_back(x(node));
  moved_ = 0.0;
  asked_ = placed_;
}

double MovingSurface::farthestMove() const {
  double farthest = 0.0;
  for (std::size_t k = 0; k < nodes_.size(); ++k) {
    const Vector3 moved = (x_.col(nodes_[k]) - fitted_[k]).cwiseAbs();
    if (!moved.allFinite()) return std::numeric_limits<double>::infinity();
    farthest = std::max(farthest, moved.maxCoeff());
  }
  return farthest;
}

/// A tree that has come a little out of date still serves: it is asked for a box that is larger by what the nodes have moved
/// since, and what does not overlap where it is now is left out.
void MovingSurface::overlapping(const Eigen::AlignedBox3d& box, std::vector<int>& triangles) {
  constexpr double kMostMoved = 0.1;  // edges: then boxes overlap needlessly often
  if (asked_ != placed_) {
    asked_ = placed_;
    moved_ = farthestMove();
    if (!(moved_ <= kMostMoved * mean_edge_)) fit();
  }
  constexpr double kRoundOff = 1e-12;  // of coordinates: the answer must not depend on when the tree was fitted
  const Vector3 moved =
      Vector3::Constant(moved_) + kRoundOff * (box.min().cwiseAbs() + box.max().cwiseAbs() + Vector3::Constant(moved_));
  tree_.overlapping({box.min() - moved, box.max() + moved}, triangles);
  const auto isAway = [&](int triangle) {
    Eigen::AlignedBox3d around;
    for (const int node : triangles_[triangle]) around.extend(x(node));
    return !around.intersects(box);
  };
  triangles.erase(std::remove_if(triangles.begin(), triangles.end(), isAway), triangles.end());
}

const Vector3& MovingSurface::normal(int triangle) {
  NormalCache& cache = normals_[triangle];
  if (cache.computed != placed_) {
    cache.computed = placed_;
    const Triangle& nodes = triangles_[triangle];
    cache.normal = triangleNormal(x(nodes[0]), x(nodes[1]), x(nodes[2]));
  }
  return cache.normal;
}

Vector3 MovingSurface::featureNormal(const SurfaceFeature& feature) {
  const bool at_vertex = feature[1] < 0;
  Vector3 sum = Vector3::Zero();
  anyTriangleOf(feature, [&](int triangle) {
    double share = 1.0;
    if (at_vertex) {
      const Triangle& nodes = triangles_[triangle];
      const int i = nodes[0] == feature[0] ? 0 : nodes[1] == feature[0] ? 1 : 2;
      const Vector3 to_next = x(nodes[(i + 1) % 3]) - x(nodes[i]);
      const Vector3 to_previous = x(nodes[(i + 2) % 3]) - x(nodes[i]);
      share = std::atan2(to_next.cross(to_previous).norm(), to_next.dot(to_previous));
    }
    sum += share * normal(triangle);
    return false;
  });
  return sum.normalized();  // leaves a zero vector alone
}

}  // namespace tissue_contact
