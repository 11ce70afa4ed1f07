/// @file
/// Room `simulation`, private: the mesh of one tissue as it follows what touches it. Where something touches or is about to, in;
/// the refined tissue, and which of its nodes are which of those before, out.
///
/// The mesh stays as it is while every place touched lies well within what is fine (fine_cells.h). Of the next one, foci near to which
/// nothing touches any more go, those of other places come, and the rest stay as they are: neither elements nor nodes change under a
/// contact that goes on, nor cells elsewhere. When: mesh_follower.h.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "mesh/bisection.h"
#include "simulation/fine_cells.h"
#include "tissue_contact/core/types.h"
#include "tissue_contact/tissue/tissue.h"
#include "tissue_contact/tissue/tissue_description.h"

namespace tissue_contact {

struct RefinableMesh;

/// From the mesh before to the present one.
struct NodeTransfer {
  std::vector<int> to_new;                  ///< per node before; -1: it is no more
  std::vector<int> from_old;                ///< per node now; -1: it is new
  std::vector<std::array<int, 2>> parents;  ///< BisectedMesh::parents of the mesh now

  /// Values at the nodes now: those that were there, and of a new node the mean of its parents, which is what the field
  /// before had there: meshes are nested, and linear in each element.
  NodalVectors carried(const NodalVectors& before) const;
};

/// The mesh that is to follow the present one.
struct NextMesh {
  FineCells cells;
  BisectedMesh mesh;
  std::optional<NodeTransfer> transfer;  ///< from the present mesh; none: it stays, whatever `mesh` holds
};

class TissueRefinement {
 public:
  /// @throws std::invalid_argument see Tissue.
  TissueRefinement(const TissueDescription& description, const Pose& X_WT, const MeshSizeCheck& on_size,
                   const MeshPreparation& preparation = {});

  /// What tissue() is made from; numbers of its materials and damping may change.
  TissueDescription& description() { return description_; }
  const Pose& worldToTissue() const { return X_TW_; }
  Tissue tissue() const { return tissue(mesh_); }  ///< with the present mesh
  Tissue tissue(const BisectedMesh& mesh) const { return {description_, X_WT_, mesh}; }
  const BisectedMesh& mesh() const { return mesh_; }
  int revision() const { return revision_; }  ///< how often the mesh has changed
  int nodesAtMost() const { return nodes_at_most_; }
  /// By what factor cells where nothing touches are longer than the body wants: 1 or more (tissue/body_edges.h).
  double bodyCoarsening() const { return body_coarsening_; }
  const FineCells& cells() const { return cells_; }

  /// The mesh that is fine around the places. Changes nothing that others of these functions read, but only one plan can be made at a
  /// time, and neither while reset() nor while carry() works.
  NextMesh plan(const std::vector<FinePlace>& places);

  /// Goes on with a mesh that was planned from the present one, which `next` then holds.
  void take(NextMesh& next);

  /// Back to the mesh that nothing touches. @return whether that is another one.
  bool reset();

  /// On reading the mesh becomes that of what was written; its revision is a later one than any before.
  void carry(StateArchive& archive);

 private:
  TissueRefinement(RefinableMesh&& mesh, const Pose& X_WT);

  bool refineWithin(const FineCells& cells, BisectedMesh& refined);
  void refineBeside(const FineCells& kept, const std::vector<FinePlace>& places, NextMesh& next);

  TissueDescription description_;
  Pose X_WT_;
  Pose X_TW_;
  Bisection bisection_;
  double body_coarsening_;
  int nodes_at_most_;
  BisectedMesh mesh_;
  FineCells cells_;
  int revision_ = 0;
};

}  // namespace tissue_contact
