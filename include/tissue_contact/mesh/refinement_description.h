/// @file
/// Room `mesh`: how fine a tissue's mesh becomes where something touches it, in SI units.
#pragma once

#include <algorithm>
#include <cstddef>

namespace tissue_contact {

/// Refinement that follows whatever touches a volume. Away from contacts the mesh is that of the scene, cut where it is too coarse for the body.
struct RefinementDescription {
  /// Whether the mesh follows: never; with cells that the advisor chooses from the shapes that touch, for short steps
  /// or for little error; with those given.
  enum class Mode { kNever, kAuto, kFine, kGiven };
  Mode mode = Mode::kNever;
  double cell_m = 0.0;    ///< edge of the finest cells; 0: chosen
  double reach_m = 0.0;   ///< how far they reach beyond what touches; 0: twice cell_m
  int nodes_at_most = 0;  ///< of the refined mesh: cells grow until it has no more; 0: chosen
  double growth = 0.0;    ///< length that cells gain per length of distance beyond the reach; 0: chosen

  /// What is chosen where it is not given. Errors and times of these and of others: tables in doc/notes/method.md, "Cells
  /// and growth". `auto` is what a step of a millisecond allows one ball. `fine` has cells small enough for vertices
  /// to carry all of the contact, and a growth below which the error falls no more.
  struct Choice {
    double cells_per_half_extent;  ///< along the smallest half extent of a shape
    double cells_of_reach;
    double growth;
    int nodes_to_come;  ///< beside the unrefined mesh's, or half as many as those if that is more
    /// Where no tool is, along the side of a cube of the body's volume and across a region (doc/notes/accuracy.md, "Coarse organs of others").
    double cells_across;
  };
  Choice choice() const {
    return mode == Mode::kFine ? Choice{8.0, 3.0, 0.2, 20000, 12.0} : Choice{3.9, 2.0, 0.35, 2000, 6.0};
  }
};

/// How many nodes the refined mesh may have. @param unrefined nodes of the mesh before.
inline std::size_t mostNodes(const RefinementDescription& refinement, std::size_t unrefined) {
  if (refinement.nodes_at_most > 0) return static_cast<std::size_t>(refinement.nodes_at_most);
  return unrefined + std::max(static_cast<std::size_t>(refinement.choice().nodes_to_come), unrefined / 2);
}

}  // namespace tissue_contact
