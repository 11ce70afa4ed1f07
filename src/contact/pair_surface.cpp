#include "contact/pair_surface.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

#include "tissue_contact/core/check.h"

namespace tissue_contact {

PairSurface::PairSurface(int tissue, TissueSurface surface, const NodalVectors& rest)
    : tissue_(tissue),
      rest_(rest),
      topology_(surface.triangles, static_cast<int>(rest.cols())),
      tree_(rest, std::move(surface.triangles)),
      fixed_(std::move(surface.fixed)),
      half_thickness_(0.5 * requireNonNegative("tissue surface: thickness", surface.thickness_m, "m")) {
  requireOneFlagPerNode(fixed_, static_cast<int>(rest.cols()));
  findEdges();
  normals_.resize(topology_.triangles().size());
}

void PairSurface::findEdges() {
  local_length_.assign(rest_.cols(), 0.0);
  std::map<std::array<int, 2>, int> known;
  double sum = 0.0;
  for (std::size_t t = 0; t < topology_.triangles().size(); ++t) {
    const Triangle& triangle = topology_.triangles()[t];
    edges_of_.emplace_back();
    for (int i = 0; i < 3; ++i) {
      const std::pair<int, int> ends = std::minmax({triangle[i], triangle[(i + 1) % 3]});
      const auto added = known.emplace(std::array<int, 2>{ends.first, ends.second}, static_cast<int>(edges_.size()));
      const int edge = edges_of_.back()[i] = added.first->second;
      if (added.second) edges_.push_back({added.first->first, {}});
      edges_[edge].triangles.push_back(static_cast<int>(t));
      if (!added.second) continue;
      const double length = (rest_.col(ends.first) - rest_.col(ends.second)).norm();
      sum += length;
      for (const int node : edges_.back().nodes) local_length_[node] = std::max(local_length_[node], length);
    }
    nodes_.insert(nodes_.end(), triangle.begin(), triangle.end());
  }
  std::sort(nodes_.begin(), nodes_.end());
  nodes_.erase(std::unique(nodes_.begin(), nodes_.end()), nodes_.end());
  Eigen::AlignedBox3d box;
  for (const int node : nodes_) box.extend(Vector3(rest_.col(node)));
  if (isVolume() && !nodes_.empty()) smallest_extent_ = box.sizes().minCoeff();
  if (!edges_.empty()) mean_edge_ = sum / static_cast<double>(edges_.size());
}

void PairSurface::place(const NodalVectors& positions) {
  positions_ = &positions;
  ++call_;
  box_.setEmpty();
  for (const int node : nodes_) box_.extend(x(node));
}

void PairSurface::refit() {
  if (refitted_ == call_) return;
  refitted_ = call_;
  tree_.refit(*positions_);
}

const Vector3& PairSurface::normal(int triangle) {
  NormalCache& cache = normals_[triangle];
  if (cache.computed != call_) {
    cache.computed = call_;
    const Triangle& nodes = topology_.triangles()[triangle];
    cache.normal = triangleNormal(x(nodes[0]), x(nodes[1]), x(nodes[2]));
  }
  return cache.normal;
}

Vector3 PairSurface::featureNormal(const SurfaceFeature& feature) {
  const bool at_vertex = feature[1] < 0;
  Vector3 sum = Vector3::Zero();
  topology_.anyTriangleOf(feature, [&](int triangle) {
    double share = 1.0;
    if (at_vertex) {
      const Triangle& nodes = topology_.triangles()[triangle];
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
