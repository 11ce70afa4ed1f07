/// @file
/// Room `tissue`, private: which triangles share an edge.
#pragma once

#include <algorithm>
#include <array>
#include <vector>

#include "tissue_contact/core/types.h"

namespace tissue_contact {

/// Edge `edge` of a triangle runs from its node `edge` to the next.
struct EdgeUse {
  std::array<int, 2> nodes;  ///< ascending
  std::size_t triangle;
  std::size_t edge;
};

/// All edges of all triangles; uses of one edge are neighbours in the list, in the order of their triangles.
inline std::vector<EdgeUse> sortedEdges(const std::vector<Triangle>& triangles) {
  std::vector<EdgeUse> uses;
  uses.reserve(3 * triangles.size());
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    for (std::size_t k = 0; k < 3; ++k) {
      const auto [low, high] = std::minmax(triangles[t][k], triangles[t][(k + 1) % 3]);
      uses.push_back({{low, high}, t, k});
    }
  }
  std::stable_sort(uses.begin(), uses.end(), [](const EdgeUse& a, const EdgeUse& b) { return a.nodes < b.nodes; });
  return uses;
}

}  // namespace tissue_contact
