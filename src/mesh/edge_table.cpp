#include "mesh/edge_table.h"

#include <algorithm>
#include <utility>

#include "tissue_contact/mesh/tissue_surface.h"

namespace tissue_contact {

EdgeTable::EdgeTable(const std::vector<Triangle>& triangles) : edges_of_(triangles.size()) {
  uses_.reserve(3 * triangles.size());
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    for (int k = 0; k < 3; ++k) {
      uses_.push_back({static_cast<int>(t), k, triangles[t][k] < triangles[t][(k + 1) % 3]});
    }
  }
  const auto nodesOf = [&](const EdgeUse& use) -> std::array<int, 2> {
    const Triangle& t = triangles[use.triangle];
    const int a = t[use.side];
    const int b = t[(use.side + 1) % 3];
    return {std::min(a, b), std::max(a, b)};
  };
  std::stable_sort(uses_.begin(), uses_.end(),
                   [&](const EdgeUse& a, const EdgeUse& b) { return nodesOf(a) < nodesOf(b); });
  for (std::size_t i = 0; i < uses_.size(); ++i) {
    const std::array<int, 2> nodes = nodesOf(uses_[i]);
    if (edges_.empty() || edges_.back().nodes != nodes) edges_.push_back({nodes, static_cast<int>(i), 0});
    ++edges_.back().count;
    edges_of_[uses_[i].triangle][uses_[i].side] = static_cast<int>(edges_.size()) - 1;
  }
}

EdgeLengths edgeLengths(const NodalVectors& x, const std::vector<Triangle>& triangles) {
  EdgeLengths lengths;
  for (const EdgeTable::Edge& edge : EdgeTable(triangles)) {
    lengths.sum_m += (x.col(edge.nodes[0]) - x.col(edge.nodes[1])).norm();
    ++lengths.count;
  }
  return lengths;
}

}  // namespace tissue_contact
