/// @file
/// Room `mesh`, private: nodes and the elements that use them.
#pragma once

#include <array>
#include <vector>

#include "tissue_contact/core/types.h"
#include "tissue_contact/mesh/triangle_mesh.h"

namespace tissue_contact {

/// The points as columns.
inline NodalVectors columnsOf(const std::vector<Vector3>& points) {
  NodalVectors columns(3, static_cast<Eigen::Index>(points.size()));
  for (std::size_t i = 0; i < points.size(); ++i) columns.col(static_cast<Eigen::Index>(i)) = points[i];
  return columns;
}

/// Triangles that share no vertices.
/// @param points three per triangle.
inline TriangleMesh separateTriangles(const std::vector<Vector3>& points) {
  TriangleMesh mesh{columnsOf(points), {}};
  for (int i = 0; i < static_cast<int>(points.size()); i += 3) mesh.triangles.push_back({i, i + 1, i + 2});
  return mesh;
}

/// Drops nodes that no element uses and renumbers the elements. @param among not null: of these nodes alone.
template <std::size_t N>
void dropUnusedNodes(NodalVectors& nodes, std::vector<std::array<int, N>>& elements,
                     const std::vector<int>* among = nullptr) {
  std::vector<int> new_index(static_cast<std::size_t>(nodes.cols()), among == nullptr ? -1 : 0);
  if (among != nullptr) {
    for (const int node : *among) new_index[static_cast<std::size_t>(node)] = -1;
  }
  for (const auto& element : elements) {
    for (const int node : element) new_index[static_cast<std::size_t>(node)] = 0;
  }
  int kept = 0;
  for (std::size_t i = 0; i < new_index.size(); ++i) {
    if (new_index[i] < 0) continue;
    const Vector3 p = nodes.col(static_cast<Eigen::Index>(i));
    nodes.col(kept) = p;
    new_index[i] = kept++;
  }
  nodes.conservativeResize(Eigen::NoChange, kept);
  for (auto& element : elements) {
    for (int& node : element) node = new_index[static_cast<std::size_t>(node)];
  }
}

}  // namespace tissue_contact
