#include "mesh/edge_table.h"

#include <algorithm>
#include <numeric>

#include "tissue_contact/mesh/tissue_surface.h"

namespace tissue_contact {

namespace {

/// Stable, by numbers from 0.
template <typename Number>
void sortBy(const Number& number, std::vector<EdgeUse>& uses) {
  std::vector<int> next;
  for (const EdgeUse& use : uses) {
    const std::size_t after = static_cast<std::size_t>(number(use)) + 1;
    if (next.size() <= after) next.resize(after + 1, 0);
    ++next[after];
  }
  std::partial_sum(next.begin(), next.end(), next.begin());
  std::vector<EdgeUse> sorted(uses.size());
  for (const EdgeUse& use : uses) sorted[next[number(use)]++] = use;
  uses.swap(sorted);
}

}  // namespace

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
  sortBy([&](const EdgeUse& use) { return nodesOf(use)[1]; }, uses_);
  sortBy([&](const EdgeUse& use) { return nodesOf(use)[0]; }, uses_);
  for (std::size_t i = 0; i < uses_.size(); ++i) {
    const std::array<int, 2> nodes = nodesOf(uses_[i]);
    if (edges_.empty() || edges_.back().nodes != nodes) edges_.push_back({nodes, static_cast<int>(i), 0});
    ++edges_.back().count;
    edges_of_[uses_[i].triangle][uses_[i].side] = static_cast<int>(edges_.size()) - 1;
  }
}

const EdgeTable::Edge* EdgeTable::find(const std::array<int, 3>& feature) const {
  if (feature[2] >= 0) return nullptr;
  const std::array<int, 2> nodes = {feature[0], feature[1]};
  const auto before = [](const Edge& edge, const std::array<int, 2>& of) { return edge.nodes < of; };
  const auto edge = std::lower_bound(edges_.begin(), edges_.end(), nodes, before);
  return edge == edges_.end() || edge->nodes != nodes ? nullptr : &*edge;
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
