/// @file
/// Room `simulation`, private: the contact pressure on tissue surfaces, for friction that depends on it. Solved contacts
/// of a step in; the pressure at any contact of the next step out.
///
/// Contacts are points, several to a face or one to many, as features and kept points have it: no area belongs to a single
/// one. The pressure is therefore that of the nodes: with the surface linear over triangles, contacts j of weights w_ja and
/// normal forces f_j load node a by F_a = sum w_ja f_j, as a pressure p does that has F_a = p A_a with A_a a third of the
/// triangles around it (the L2 projection of the contact forces with a lumped mass). At a contact i
///   p_i = sum w_ia F_a / A_a.
/// Exact for a uniform pressure on a whole face, whatever points carry it and in whatever order; sum p_a A_a is the force.
/// At the edge of a patch A_a is cut (facingArea). Measured on a sphere that slides (validation, pressure-friction), with
/// friction that goes with p^(-1/3): +0.5 and +1.4 %, 1.1 % noise from step to step, with 3 and 5 cells per contact radius.
/// Whole triangles give +7.5 and +5.4 %, 0.4 % noise; only those with three nodes that bear -2.7 and -1.4 %, 2.1 % (sharing
/// thirds: +3.2 and +2.9 %, 0.8 %). Those two bracket the area kept, hence the pressure, and both go to 0 with the cells.
/// Finer than a cell no pressure is resolved: a tip smaller than that presses on about the area of a triangle or two.
#pragma once

#include <array>
#include <vector>

#include "simulation/triangles_of_nodes.h"
#include "tissue_contact/contact/contact.h"
#include "tissue_contact/core/types.h"
#include "tissue_contact/simulation/solved_contact.h"
#include "tissue_contact/tissue/tissue.h"

namespace tissue_contact {

/// No allocation once vectors have grown.
class ContactPressure {
 public:
  /// @param tissues must outlive this.
  explicit ContactPressure(const std::vector<Tissue>& tissues);

  /// Goes on with another surface of a tissue, whose triangles are exchanged for those before. Nothing presses any more.
  void swapSurface(int tissue, TrianglesOfNodes& triangles);

  void clear();  ///< nothing presses

  /// Keeps the normal forces of a step in place of those before.
  void remember(const std::vector<SolvedContact>& contacts);

  /// The pressure where a contact is, Pa, >= 0; 0 where nothing pressed in the step remembered. Between tissues the larger
  /// one of both sides: a side whose face reaches beyond the patch, or with cells larger than it, spreads it.
  /// @param x deformed positions per tissue, m.
  double at(const Contact& contact, const std::vector<NodalVectors>& x) const;

 private:
  struct Load {
    int tissue = 0;
    int node = 0;
    Vector3 force_W;  ///< along the contact's normal into the tissue, N
    int next = -1;    ///< index of another load of the same node, -1: none
  };
  struct Surface {
    TrianglesOfNodes triangles_of_node;
    std::vector<int> first_load;  ///< per node; -1: none
  };

  void add(int tissue, const std::array<int, 3>& nodes, const Vector3& weights, const Vector3& force_W);
  double onSide(int tissue, const std::array<int, 3>& nodes, const Vector3& weights, const Vector3& n,
                const NodalVectors& x) const;
  double forceOn(int tissue, int node, const Vector3& n) const;
  bool isTouchedFrom(int tissue, int node, const Vector3& n) const;
  double facingArea(int tissue, int node, const Vector3& n, const NodalVectors& x) const;

  const std::vector<Tissue>& tissues_;
  std::vector<Surface> surfaces_;  ///< per tissue
  std::vector<Load> loads_;
};

}  // namespace tissue_contact
