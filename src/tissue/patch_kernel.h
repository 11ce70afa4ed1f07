/// @file
/// Room `tissue`, private: what the force kernels of patches share: four patches at a time, or eight, each an element of several nodes. Node
/// positions in, mean deformation gradients out; stresses in, nodal forces out.
#pragma once

#include "tissue/lanes.h"
#include "tissue/patch_elements.h"

namespace tissue_contact {

/// forBatches() of batches of patches: two at a time where both have as many nodes.
template <typename Kernel>
TISSUE_CONTACT_INLINE void forPatchBatches(const PatchElements& patches, BatchRange range, const Kernel& kernel) {
  forBatches(range, [&](std::size_t b, auto width) TISSUE_CONTACT_ALWAYS_INLINE {
    constexpr std::size_t kBatches = kFours<typename decltype(width)::Type>;
    if (kBatches == 1 || patches.batches[b].count == patches.batches[b + 1].count) {
      kernel(b, width);
    } else {
      for (std::size_t i = 0; i < kBatches; ++i) kernel(b + i, Width<Lanes>());
    }
  });
}

/// The nodes of each batch that L holds.
template <typename L>
TISSUE_CONTACT_INLINE std::array<const PatchNode*, kFours<L>> nodesOf(const PatchElements& patches, std::size_t batch) {
  std::array<const PatchNode*, kFours<L>> nodes;
  for (std::size_t i = 0; i < kFours<L>; ++i) nodes[i] = &patches.nodes[patches.batches[batch + i].first];
  return nodes;
}

/// x, y and z of node n of each patch.
template <typename L>
TISSUE_CONTACT_INLINE void gatherNodes(const std::array<const PatchNode*, kFours<L>>& nodes, std::size_t n,
                                       const PaddedVector* x, L* to) {
  std::array<const int*, kFours<L>> places;
  for (std::size_t i = 0; i < kFours<L>; ++i) places[i] = nodes[i][n].nodes.data();
  gatherEach(x, places, to);
}

/// Mean F of each patch.
template <typename L>
TISSUE_CONTACT_INLINE void meanGradients(const PatchElements& patches, std::size_t batch, const PaddedVector* x,
                                         LaneMatrixOf<L>& F) {
  const auto nodes = nodesOf<L>(patches, batch);
  L origin[3];
  gatherNodes(nodes, 0, x, origin);
  for (L& entry : F.m) entry = L{};
  for (std::size_t n = 1; n < patches.batches[batch].count; ++n) {
    L d[3];
    gatherNodes(nodes, n, x, d);
    for (std::size_t r = 0; r < 3; ++r) d[r] -= origin[r];
    for (std::size_t c = 0; c < 3; ++c) {
      L g;
      loadEach(g, [=](std::size_t i) { return &(*nodes[i][n].gradient)[c]; });
      for (std::size_t r = 0; r < 3; ++r) F.m[r + 3 * c] += d[r] * g;
    }
  }
}

/// Forces -V P grad N of the stresses P of four patches, added to their nodes.
TISSUE_CONTACT_INLINE void addPatchStressForces(const PatchElements& patches, const PatchBatch& batch, LaneMatrix& P,
                                                PaddedVector* forces) {
  const PatchNode* const nodes = &patches.nodes[batch.first];
  Lanes volume;
  load(batch.volume, volume);
  for (Lanes& entry : P.m) entry *= -volume;
  for (std::size_t n = 0; n < batch.count; ++n) {
    Lanes g0, g1, g2;
    load((*nodes[n].gradient)[0], g0);
    load((*nodes[n].gradient)[1], g1);
    load((*nodes[n].gradient)[2], g2);
    Lanes force[3];
    for (std::size_t r = 0; r < 3; ++r) force[r] = P.m[r] * g0 + P.m[r + 3] * g1 + P.m[r + 6] * g2;
    scatterAdd(force, nodes[n].nodes.data(), forces);
  }
}

/// The same of each batch that L holds, one after the other, so that sums of a node have the same order for any L.
template <typename L>
TISSUE_CONTACT_INLINE void addPatchStressForces(const PatchElements& patches, std::size_t first,
                                                const LaneMatrixOf<L>& P, PaddedVector* forces) {
  Lanes fours[9][kFours<L>];
  for (std::size_t k = 0; k < 9; ++k) split(P.m[k], fours[k]);
  for (std::size_t i = 0; i < kFours<L>; ++i) {
    LaneMatrix of_batch;
    for (std::size_t k = 0; k < 9; ++k) of_batch.m[k] = fours[k][i];
    addPatchStressForces(patches, patches.batches[first + i], of_batch, forces);
  }
}

}  // namespace tissue_contact
