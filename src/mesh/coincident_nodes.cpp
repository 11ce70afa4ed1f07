#include "mesh/coincident_nodes.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <limits>
#include <numeric>

#include "mesh/point_grid.h"

namespace tissue_contact {

std::vector<int> firstInPlace(const std::vector<Vector3>& nodes, const std::vector<bool>& used, double shortest_edge) {
  std::vector<int> first(nodes.size());
  std::iota(first.begin(), first.end(), 0);
  Vector3 low = Vector3::Constant(std::numeric_limits<double>::infinity());
  Vector3 high = -low;
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    if (!used[i]) continue;
    low = low.cwiseMin(nodes[i]);
    high = high.cwiseMax(nodes[i]);
  }
  const double diagonal = (high - low).stableNorm();
  if (!(diagonal > 0.0) || !std::isfinite(diagonal)) return first;
  constexpr double kSinglePrecision =
      0x1p-21;  // both rounded, in three coordinates: less than four units in the last place
  const double resolved = kSinglePrecision * std::max(low.cwiseAbs().maxCoeff(), high.cwiseAbs().maxCoeff());
  PointGrid grid(low, std::max(kMergeDistance * diagonal, std::min(resolved, 1e-3 * shortest_edge)));
  std::vector<int> filed;  // the node of each point of the grid
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    if (!used[i]) continue;
    const auto point = static_cast<std::size_t>(grid.findOrAdd(nodes[i]));
    if (point == filed.size()) filed.push_back(static_cast<int>(i));
    first[i] = filed[point];
  }
  return first;
}

NearNodes findNearNodes(const TetMesh& mesh) {
  constexpr double kNear = 0.01;
  constexpr double kNone = std::numeric_limits<double>::infinity();
  const auto nodes = static_cast<std::size_t>(mesh.positions.cols());
  const auto at = [&](std::size_t node) -> Vector3 { return mesh.positions.col(static_cast<Eigen::Index>(node)); };
  std::vector<double> shortest(nodes, kNone);  // of the edges at a node
  for (const Tetrahedron& tet : mesh.tetrahedra) {
    for (std::size_t i = 0; i < 4; ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        const auto a = static_cast<std::size_t>(tet[i]), b = static_cast<std::size_t>(tet[j]);
        const double edge = (at(a) - at(b)).norm();
        shortest[a] = std::min(shortest[a], edge);
        shortest[b] = std::min(shortest[b], edge);
      }
    }
  }
  std::vector<double> usual;
  std::copy_if(shortest.begin(), shortest.end(), std::back_inserter(usual),
               [](double edge) { return edge > 0.0 && edge < kNone; });
  NearNodes near;
  if (usual.empty()) return near;
  const auto middle = usual.begin() + static_cast<std::ptrdiff_t>(usual.size() / 2);
  std::nth_element(usual.begin(), middle, usual.end());
  PointGrid grid(mesh.positions.rowwise().minCoeff(), kNear * *middle);
  std::vector<std::size_t> filed;  // the node of each point of the grid
  for (std::size_t i = 0; i < nodes; ++i) {
    if (shortest[i] == kNone) continue;
    const auto point = static_cast<std::size_t>(grid.findOrAdd(at(i)));
    if (point == filed.size()) {
      filed.push_back(i);
      continue;
    }
    const std::size_t other = filed[point];
    if (!((at(i) - at(other)).norm() < kNear * std::min(shortest[i], shortest[other]))) continue;
    if (near.count++ == 0) near = {1, static_cast<int>(other), static_cast<int>(i)};
  }
  return near;
}

}  // namespace tissue_contact
