/// @file
/// Room `tissue`, private: patches as neo-Hookean elements of several nodes, with the mean F of their tetrahedra: what of the resistance
/// is averaged over them (neo_hookean.h). Positions in; forces and their share of the stiffness out.
#pragma once

#include <utility>
#include <vector>

#include "tissue/neo_hookean_kernel.h"
#include "tissue/neo_hookean_stiffness.h"
#include "tissue/patch_elements.h"

namespace tissue_contact {

class NeoHookeanPatches {
 public:
  /// Deformation gradients are kept four patches at a time, as those of elements are.
  struct State {
    std::vector<MatrixBatch> deformations;          ///< scratch: of each patch at the last update
    std::vector<MatrixBatch> tangent_deformations;  ///< those the stiffness was computed with
    std::vector<unsigned char> changed;             ///< scratch: patches to refresh, a bit each
    std::vector<BatchRange> moving;
    std::vector<BatchRange> still;

    void carry(StateArchive& archive);
  };

  /// @param patches whose materials are the model's lambda and mu.
  explicit NeoHookeanPatches(PatchElements patches) : patches_(std::move(patches)) {}

  State undeformed() const;
  void split(const std::vector<bool>& still, State& state) const { patches_.split(still, state.moving, state.still); }

  /// Adds the forces of these batches of patches, and marks those whose F has changed by more than `tangent_change` since their
  /// stiffness was made.
  void addForces(const std::vector<BatchRange>& ranges, double tangent_change, State& state, KernelNodes& nodes) const;

  /// Adds the number of those marked. @return whether one was so deformed that taking its share out leaves round-off behind.
  bool countChanged(const std::vector<BatchRange>& ranges, const State& state, std::size_t& changed) const;

  /// Those marked get a new share for their old one. @param rebuilds all will be added anew: only their F is taken over.
  void refresh(const std::vector<BatchRange>& ranges, bool rebuilds, State& state, NeoHookeanStiffness& sum) const;

  /// Adds the shares of all.
  void addStiffness(const State& state, NeoHookeanStiffness& sum) const;

  double energy(const NodalVectors& x) const;

  std::size_t size() const { return patches_.size(); }
  std::size_t mostNodes() const { return patches_.most_nodes; }

 private:
  void addShare(std::size_t patch, const MatrixBatch& F, double sign, NeoHookeanStiffness& sum) const;

  PatchElements patches_;
};

}  // namespace tissue_contact
