#include "tissue/body_edges.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <variant>

#include "mesh/region.h"

namespace tissue_contact {

double longestBodyEdge(const NodalVectors& rest, const std::vector<Tetrahedron>& tetrahedra,
                       const RefinementDescription& refinement) {
  double volume_m3 = 0.0;
  for (const Tetrahedron& nodes : tetrahedra) volume_m3 += signedVolume(rest, nodes);
  return std::sqrt(3.0) * std::cbrt(volume_m3) / refinement.choice().cells_along_body;
}

void refineBody(const TetMesh& mesh, const TissueDescription& tissue, Bisection& bisection) {
  constexpr double kLonger = 1.4142135623730951;
  constexpr double kShortest = 1e-3;  // of the mesh's size: of flat bodies, so that few attempts find what fits
  const auto unrefined = static_cast<std::size_t>(mesh.positions.cols());
  const std::size_t most_nodes = mostNodes(tissue.refinement, unrefined);
  if (most_nodes <= unrefined) return;
  const bool is_block = std::holds_alternative<BlockDescription>(tissue.geometry);  // its cells are as the scene says
  const double rounding = roundingDistance(mesh.positions);
  const double size_m = (mesh.positions.rowwise().maxCoeff() - mesh.positions.rowwise().minCoeff()).norm();
  double edge_m = std::max(longestBodyEdge(mesh.positions, mesh.tetrahedra, tissue.refinement), kShortest * size_m);
  if (!(edge_m > 0.0)) return;  // lengths whose products underflow
  const auto limit = [&](const std::array<Vector3, 4>& corners) {
    double squared_m2 = 0.0;
    for (const Vector3& a : corners) {
      for (const Vector3& b : corners) squared_m2 = std::max(squared_m2, (a - b).squaredNorm());
    }
    const bool may_be_cut = squared_m2 > 0.25 * edge_m * edge_m;  // spares looking at the places of `fixed`
    if (may_be_cut && bordersIn(tissue.fixed, corners, rounding)) return 0.5 * edge_m;
    return is_block ? std::numeric_limits<double>::infinity() : edge_m;
  };
  while (!bisection.refineLasting(limit, unrefined + (most_nodes - unrefined) / 2)) edge_m *= kLonger;
}

}  // namespace tissue_contact
