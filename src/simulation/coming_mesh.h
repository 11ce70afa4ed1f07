/// @file
/// Room `simulation`, private: all that is made from the mesh of a tissue, made before it is needed. A refined mesh in; what its tissue,
/// surface, watches and elastic state will be out, each to be exchanged for what is there.
#pragma once

#include <memory>
#include <optional>

#include "mesh/surface/moving_surface.h"
#include "simulation/detection_margins.h"
#include "simulation/fold_watch.h"
#include "simulation/load_watch.h"
#include "simulation/tissue_refinement.h"
#include "simulation/triangles_of_nodes.h"
#include "tissue_contact/tissue/elasticity.h"
#include "tissue_contact/tissue/tissue.h"

namespace tissue_contact {

/// Once it has been taken it holds what was before, to be done away with wherever there is time.
struct ComingMesh {
  NextMesh next = {FineCells(RefinementDescription()), {}, std::nullopt};
  std::optional<Tissue> tissue;  ///< none: the mesh stays, and there is nothing of what follows
  std::optional<MovingSurface> surface;
  SurfaceEdges::Lengths edges;
  LoadWatch::Mesh loads;
  TrianglesOfNodes friction_triangles, pressure_triangles;
  std::optional<ConvexBody> fold;
  std::unique_ptr<Elasticity::State> elastic_state;  ///< null: nobody knows yet where its nodes will be
};

/// What of a tissue is needed: const while meshes change.
struct MeshUsers {
  int tissue;  ///< its index
  ElasticModel law;
  bool pressure;  ///< friction depends on it
  const FoldWatch* folds;
};

/// All but `next` and the elastic state. @param tissue with its mesh.
void makeParts(Tissue tissue, const MeshUsers& users, ComingMesh& coming);

/// Elastic state and surface of the tissue where its nodes are.
/// @param x of its nodes, m, world frame; fixed ones are where they rest, whatever it says.
void makeStateAt(NodalVectors x, ComingMesh& coming);

}  // namespace tissue_contact
