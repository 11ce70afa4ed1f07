#include "mesh/coincident_nodes.h"

#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>

#include "mesh/point_grid.h"

namespace tissue_contact {

std::vector<int> firstInPlace(const std::vector<Vector3>& nodes, const std::vector<bool>& used) {
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
  PointGrid grid(low, kMergeDistance * diagonal);
  std::vector<int> filed;  // the node of each point of the grid
  for (std::size_t i = 0; i < nodes.size(); ++i) {
    if (!used[i]) continue;
    const auto point = static_cast<std::size_t>(grid.findOrAdd(nodes[i]));
    if (point == filed.size()) filed.push_back(static_cast<int>(i));
    first[i] = filed[point];
  }
  return first;
}

}  // namespace tissue_contact
