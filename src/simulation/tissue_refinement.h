/// @file
/// Room `simulation`, private: the mesh of one tissue as it follows what touches it. Where something touches or is about to, in;
/// the refined tissue, and which of its nodes are which of those before, out.
///
/// Cells are fine around foci, and longer by kGrowth per metre beyond their reach. The mesh stays as it is while every place
/// touched lies well within the reach of a focus. Then foci near to which nothing touches any more go, those of other places come,
/// and the rest stay as they are: neither elements nor nodes change under a contact that goes on, nor cells elsewhere.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "mesh/bisection.h"
#include "tissue_contact/core/types.h"
#include "tissue_contact/tissue/tissue.h"
#include "tissue_contact/tissue/tissue_description.h"

namespace tissue_contact {

struct RefinableMesh;

/// A place of a tissue's surface that is to be fine.
struct TouchedPlace {
  Vector3 rest_W;       ///< at rest, m, world frame
  double cell_m = 0.0;  ///< edge of the cells there
};

/// From the mesh before to the present one.
struct NodeTransfer {
  std::vector<int> to_new;                  ///< per node before; -1: it is no more
  std::vector<int> from_old;                ///< per node now; -1: it is new
  std::vector<std::array<int, 2>> parents;  ///< BisectedMesh::parents of the mesh now

  /// Values at the nodes now: those that were there, and of a new node the mean of its parents, which is what the field
  /// before had there: meshes are nested, and linear in each element.
  NodalVectors carried(const NodalVectors& before) const;
};

class TissueRefinement {
 public:
  /// Length that cells gain per length of distance beyond the reach: steeper ones err more with as many nodes (doc/accuracy.md).
  static constexpr double kGrowth = 0.5;

  /// @throws std::invalid_argument see Tissue.
  TissueRefinement(const TissueDescription& description, const Pose& X_WT, const MeshSizeCheck& on_size,
                   const MeshPreparation& preparation = {});

  /// What tissue() is made from; numbers of its materials and damping may change.
  TissueDescription& description() { return description_; }
  Tissue tissue() const { return {description_, X_WT_, mesh_}; }  ///< with the present mesh
  int revision() const { return revision_; }                      ///< how often the mesh has changed
  int nodesAtMost() const { return nodes_at_most_; }

  /// Refines the mesh around the places if one of them is not well within what is fine.
  /// @param places none: the mesh stays as it is.
  /// @return how nodes went over to another mesh; none: it stays as it is.
  std::optional<NodeTransfer> follow(const std::vector<TouchedPlace>& places);

  /// Back to the unrefined mesh. @return whether that is another one.
  bool reset();

  /// On reading the mesh becomes that of what was written; its revision is a later one than any before.
  void carry(StateArchive& archive);

  /// By what factor cells of the newest foci are longer than asked for, to have no more nodes than allowed: 1 or more; 1 while nothing
  /// touches.
  double coarsening() const { return places_.empty() ? 1.0 : coarsening_; }

  /// How far fine cells reach beyond a place, m.
  double reach(double cell_m) const;

 private:
  TissueRefinement(RefinableMesh&& mesh, const Pose& X_WT);

  struct Focus {
    Vector3 p_T;
    double asked_m;     ///< cells that a place asked for
    double coarsening;  ///< what they are longer by
  };
  struct Place {
    Vector3 p_T;
    double cell_m;
  };
  bool covers(const Focus& focus, const Place& place, double share) const;
  bool isCovered(const Place& place, double share) const;
  double longestEdge(const Vector3& p_T) const;
  void dropFoci();
  void addFoci();
  void refineBeside(const std::vector<Focus>& kept, BisectedMesh& refined);
  bool refineWithin(BisectedMesh& refined);

  TissueDescription description_;
  Pose X_WT_;
  Pose X_TW_;
  Bisection bisection_;
  int nodes_at_most_;
  BisectedMesh mesh_;
  std::vector<Focus> foci_;
  std::vector<Place> places_;  ///< scratch
  double coarsening_ = 1.0;
  int revision_ = 0;
};

}  // namespace tissue_contact
