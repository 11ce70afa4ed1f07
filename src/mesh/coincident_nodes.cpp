#include "mesh/coincident_nodes.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <iterator>
#include <limits>
#include <numeric>
#include <utility>

#include "mesh/edge_table.h"
#include "mesh/nodes.h"
#include "mesh/point_grid.h"

namespace tissue_contact {
namespace {

/// Lowest and highest coordinates of the nodes that `counts` says; infinite where there are none.
template <class Counts>
std::pair<Vector3, Vector3> boxOf(const NodalVectors& nodes, const Counts& counts) {
  Vector3 low = Vector3::Constant(std::numeric_limits<double>::infinity());
  Vector3 high = -low;
  for (Eigen::Index i = 0; i < nodes.cols(); ++i) {
    if (!counts(static_cast<std::size_t>(i))) continue;
    low = low.cwiseMin(nodes.col(i));
    high = high.cwiseMax(nodes.col(i));
  }
  return {low, high};
}

}  // namespace

std::vector<int> firstInPlace(const std::vector<Vector3>& nodes, const std::vector<bool>& used, double shortest_edge) {
  std::vector<int> first(nodes.size());
  std::iota(first.begin(), first.end(), 0);
  const auto [low, high] = boxOf(columnsOf(nodes), [&](std::size_t node) { return used[node]; });
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

namespace {

constexpr double kNone = std::numeric_limits<double>::infinity();

/// Of the edges at each node; kNone at those of no element.
template <std::size_t N>
std::vector<double> shortestEdges(const NodalVectors& positions, const std::vector<std::array<int, N>>& elements) {
  std::vector<double> shortest(static_cast<std::size_t>(positions.cols()), kNone);
  for (const auto& element : elements) {
    for (std::size_t i = 0; i < N; ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        const double edge = (positions.col(element[i]) - positions.col(element[j])).norm();
        for (const int node : {element[i], element[j]}) {
          double& at = shortest[static_cast<std::size_t>(node)];
          at = std::min(at, edge);
        }
      }
    }
  }
  return shortest;
}

std::vector<bool> nodesOfSurface(const TetMesh& mesh) {
  std::vector<bool> outside(static_cast<std::size_t>(mesh.positions.cols()), false);
  for (const Triangle& triangle : boundaryTriangles(mesh.tetrahedra)) {
    for (const int node : triangle) outside[static_cast<std::size_t>(node)] = true;
  }
  return outside;
}

std::vector<bool> nodesOfBorder(const TriangleMesh& mesh) {
  std::vector<bool> outside(static_cast<std::size_t>(mesh.vertices.cols()), false);
  for (const EdgeTable::Edge& edge : EdgeTable(mesh.triangles)) {
    if (edge.count != 1) continue;
    for (const int node : edge.nodes) outside[static_cast<std::size_t>(node)] = true;
  }
  return outside;
}

/// @param nodesOutside says which nodes are, where any are near to each other.
template <std::size_t N, class NodesOutside>
NearNodes findNear(const NodalVectors& positions, const std::vector<std::array<int, N>>& elements,
                   const NodesOutside& nodesOutside) {
  constexpr double kNear = 0.01;
  const std::vector<double> shortest = shortestEdges(positions, elements);
  std::vector<double> usual;
  std::copy_if(shortest.begin(), shortest.end(), std::back_inserter(usual),
               [](double edge) { return edge > 0.0 && edge < kNone; });
  if (usual.empty()) return {};
  const auto middle = usual.begin() + static_cast<std::ptrdiff_t>(usual.size() / 2);
  std::nth_element(usual.begin(), middle, usual.end());
  const auto [low, high] = boxOf(positions, [&](std::size_t node) { return shortest[node] != kNone; });
  const double diagonal = (high - low).stableNorm();
  if (!std::isfinite(diagonal)) return {};
  // No nearer than nodes in one place, or cells of the grid would be too many to count.
  PointGrid grid(low, std::max(kNear * *middle, kMergeDistance * diagonal));
  std::vector<int> filed;                  // the node of each point of the grid
  std::vector<std::pair<int, int>> pairs;  // that are near
  for (int i = 0; i < static_cast<int>(shortest.size()); ++i) {
    const double edge = shortest[static_cast<std::size_t>(i)];
    if (edge == kNone) continue;
    const Vector3 here = positions.col(i);
    const auto point = static_cast<std::size_t>(grid.findOrAdd(here));
    if (point == filed.size()) {
      filed.push_back(i);
      continue;
    }
    const int other = filed[point];
    const double limit = kNear * std::min(edge, shortest[static_cast<std::size_t>(other)]);
    if ((here - positions.col(other)).norm() < limit) pairs.emplace_back(other, i);
  }
  if (pairs.empty()) return {};
  const std::vector<bool> outside =
      nodesOutside();  // where a mesh is cut open there is one; flat elements have near nodes, too
  NearNodes near;
  for (const auto& [one, other] : pairs) {
    if (!outside[static_cast<std::size_t>(one)] || !outside[static_cast<std::size_t>(other)]) continue;
    if (near.count++ == 0) near = {1, one, other};
  }
  return near;
}

}  // namespace

NearNodes findNearNodes(const TetMesh& mesh) {
  return findNear(mesh.positions, mesh.tetrahedra, [&] { return nodesOfSurface(mesh); });
}

NearNodes findNearNodes(const TriangleMesh& mesh) {
  return findNear(mesh.vertices, mesh.triangles, [&] { return nodesOfBorder(mesh); });
}

}  // namespace tissue_contact
