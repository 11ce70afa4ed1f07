/// @file
/// Room `tissue`, private: adds shares of elements and of patches to the neo-Hookean stiffness, four computed at a time.
#pragma once

#include <algorithm>
#include <array>
#include <vector>

#include "tissue/neo_hookean_tangent.h"
#include "tissue_contact/tissue/elasticity.h"

namespace tissue_contact {

class NeoHookeanStiffness {
 public:
  /// Kept from step to step, so that none allocates.
  struct Scratch {
    explicit Scratch(std::size_t most_nodes)
        : gradients(most_nodes), turned(most_nodes), blocks(most_nodes * (most_nodes + 1) / 2) {}

    std::vector<GradientLanes> gradients;
    std::vector<GradientLanes> turned;
    std::vector<MatrixBatch> blocks;
  };

  /// What an element or a patch gives.
  struct Share {
    const MatrixBatch& F;  ///< in `lane`
    std::size_t lane;
    LameParameters material;  ///< lambda and mu of the model, Pa
    InPatch patch;
    double volume_m3;  ///< negative: to be taken out again
    double damping_s;
    std::size_t nodes;
    const int* slots;  ///< of node pairs i <= j, row by row, as BlockSlots
  };

  NeoHookeanStiffness(Scratch& scratch, Elasticity::State& state) : scratch_(scratch), state_(state) {}
  ~NeoHookeanStiffness() { addAll(); }  // those that did not make four
  NeoHookeanStiffness(const NeoHookeanStiffness&) = delete;
  NeoHookeanStiffness& operator=(const NeoHookeanStiffness&) = delete;

  /// In the order of the calls. @param gradientOf a node of the share: that of its shape function, 1/m.
  template <typename GradientOf>
  void add(const Share& share, const GradientOf& gradientOf) {
    for (std::size_t n = 0; n < share.nodes; ++n) {
      const Vector3 gradient = gradientOf(n);
      for (std::size_t k = 0; k < 3; ++k) scratch_.gradients[n][k][count_] = gradient.data()[k];
    }
    place(share);
  }

 private:
  /// Where a share that waits for others goes.
  struct Waiting {
    std::size_t nodes;
    const int* slots;
    double damping_s;
  };

  void place(const Share& share);
  void addAll();
  void addTo(std::size_t lane, std::size_t most, bool failed);

  Scratch& scratch_;
  Elasticity::State& state_;
  TangentLanes lanes_ = {};  // lanes that nobody fills have numbers, too
  std::array<Waiting, kLanes> waiting_ = {};
  std::size_t count_ = 0;
};

}  // namespace tissue_contact
