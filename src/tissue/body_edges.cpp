#include "tissue/body_edges.h"

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
  const auto unrefined = static_cast<std::size_t>(mesh.positions.cols());
  const std::size_t most_nodes = mostNodes(tissue.refinement, unrefined);
  if (most_nodes <= unrefined) return;
  const bool is_block = std::holds_alternative<BlockDescription>(tissue.geometry);  // its cells are as the scene says
  const double rounding = roundingDistance(mesh.positions);
  double edge_m = longestBodyEdge(mesh.positions, mesh.tetrahedra, tissue.refinement);
  const auto fits = [&] {
    const auto limit = [fixed = tissue.fixed, rounding, edge_m, is_block](const std::array<Vector3, 4>& corners) {
      if (bordersIn(fixed, corners, rounding)) return 0.5 * edge_m;
      return is_block ? std::numeric_limits<double>::infinity() : edge_m;
    };
    return bisection.refineLasting(limit, unrefined + (most_nodes - unrefined) / 2);
  };
  while (!fits()) edge_m *= kLonger;
}

}  // namespace tissue_contact
