#include "simulation/coming_mesh.h"

#include <utility>

#include "simulation/friction_table.h"

namespace tissue_contact {

void makeParts(Tissue tissue, const MeshUsers& users, ComingMesh& coming) {
  coming.tissue = std::move(tissue);
  const Tissue& made = *coming.tissue;
  coming.surface.emplace(users.tissue, TissueSurface{made.surface(), made.fixed(), made.thickness()},
                         made.restPositions());
  coming.edges = SurfaceEdges::lengthsOf(made);
  coming.loads = LoadWatch::meshOf(made, users.law);
  coming.friction_triangles = FrictionTable::trianglesOf(made);
  if (users.pressure) coming.pressure_triangles = trianglesOfNodes(made);
  coming.fold = users.folds->bodyOf(users.tissue, made);
  coming.elastic_state.reset();
}

void makeStateAt(NodalVectors x, ComingMesh& coming) {
  const Tissue& tissue = *coming.tissue;
  for (int i = 0; i < tissue.nodeCount(); ++i) {
    if (tissue.fixed()[i]) x.col(i) = tissue.restPositions().col(i);
  }
  coming.surface->fit(x);
  coming.elastic_state = tissue.elasticity().makeStateAt(x);
}

}  // namespace tissue_contact
