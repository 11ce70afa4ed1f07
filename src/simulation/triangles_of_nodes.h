/// @file
/// Room `simulation`, private: which surface triangles each node of a tissue has.
#pragma once

#include <vector>

#include "tissue_contact/tissue/tissue.h"

namespace tissue_contact {

using TrianglesOfNodes = std::vector<std::vector<int>>;

inline TrianglesOfNodes trianglesOfNodes(const Tissue& tissue) {
  TrianglesOfNodes triangles(static_cast<std::size_t>(tissue.nodeCount()));
  for (std::size_t i = 0; i < tissue.surface().size(); ++i) {
    for (const int node : tissue.surface()[i]) triangles[node].push_back(static_cast<int>(i));
  }
  return triangles;
}

}  // namespace tissue_contact
