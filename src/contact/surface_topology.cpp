#include "contact/surface_topology.h"

#include <algorithm>
#include <stdexcept>
#include <string>
#include <utility>

namespace tissue_contact {
namespace {

void checkTriangle(const Triangle& triangle, std::size_t index, int node_count) {
  for (const int node : triangle) {
    if (node >= 0 && node < node_count) continue;
    throw std::invalid_argument("tissue surface: triangle " + std::to_string(index) + " refers to node " +
                                std::to_string(node) + "; it must be in [0, " + std::to_string(node_count - 1) + "]");
  }
  if (triangle[0] == triangle[1] || triangle[1] == triangle[2] || triangle[2] == triangle[0]) {
    throw std::invalid_argument("tissue surface: triangle " + std::to_string(index) +
                                " refers to the same node twice; its three nodes must differ");
  }
}

}  // namespace

void requireOneFlagPerNode(const std::vector<bool>& fixed, int node_count) {
  if (static_cast<int>(fixed.size()) == node_count) return;
  throw std::invalid_argument("tissue surface: " + std::to_string(fixed.size()) + " fixed flags for " +
                              std::to_string(node_count) + " nodes; there must be one per node");
}

SurfaceTopology::SurfaceTopology(std::vector<Triangle> triangles, int node_count) : triangles_(std::move(triangles)) {
  fan_start_.assign(node_count + 1, 0);
  for (std::size_t t = 0; t < triangles_.size(); ++t) {
    checkTriangle(triangles_[t], t, node_count);
    for (const int node : triangles_[t]) ++fan_start_[node + 1];
  }
  for (int node = 0; node < node_count; ++node) fan_start_[node + 1] += fan_start_[node];
  fan_.resize(3 * triangles_.size());
  std::vector<int> next(fan_start_.begin(), fan_start_.end() - 1);
  for (std::size_t t = 0; t < triangles_.size(); ++t) {
    for (const int node : triangles_[t]) fan_[next[node]++] = static_cast<int>(t);
  }
}

SurfaceFeature SurfaceTopology::featureOf(int triangle, const Vector3& weights) const {
  SurfaceFeature feature = {-1, -1, -1};
  int count = 0;
  for (int i = 0; i < 3; ++i) {
    if (!(weights[i] > 0.0)) continue;
    int place = count++;
    for (const int node = triangles_[triangle][i]; place >= 0; --place) {
      if (place == 0 || feature[place - 1] < node) {
        feature[place] = node;
        break;
      }
      feature[place] = feature[place - 1];
    }
  }
  return feature;
}

bool SurfaceTopology::contains(int triangle, const SurfaceFeature& feature) const {
  const Triangle& nodes = triangles_[triangle];
  const auto has = [&](int node) { return node < 0 || node == nodes[0] || node == nodes[1] || node == nodes[2]; };
  return has(feature[1]) && has(feature[2]);
}

}  // namespace tissue_contact
