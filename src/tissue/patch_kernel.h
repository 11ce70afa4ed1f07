/// @file
/// Room `tissue`, private: what the force kernels of patches share: four patches at a time, each an element of several nodes. Node
/// positions in, mean deformation gradients out; stresses in, nodal forces out.
#pragma once

#include "tissue/lanes.h"
#include "tissue/patch_elements.h"

namespace tissue_contact {

/// Mean F of each of four patches.
TISSUE_CONTACT_INLINE void meanGradients(const PatchNode* nodes, std::size_t count, const PaddedVector* x,
                                         LaneMatrix& F) {
  Lanes origin[3];
  gather(x, nodes[0].nodes.data(), origin);
  for (Lanes& entry : F.m) entry = Lanes{};
  for (std::size_t i = 1; i < count; ++i) {
    Lanes d[3];
    gather(x, nodes[i].nodes.data(), d);
    for (std::size_t r = 0; r < 3; ++r) d[r] -= origin[r];
    for (std::size_t c = 0; c < 3; ++c) {
      Lanes g;
      load((*nodes[i].gradient)[c], g);
      for (std::size_t r = 0; r < 3; ++r) F.m[r + 3 * c] += d[r] * g;
    }
  }
}

/// Forces -V P grad N of the stresses P of four patches, added to their nodes.
TISSUE_CONTACT_INLINE void addPatchStressForces(const PatchBatch& batch, const PatchNode* nodes, LaneMatrix& P,
                                                PaddedVector* forces) {
  Lanes volume;
  load(batch.volume, volume);
  for (Lanes& entry : P.m) entry *= -volume;
  for (std::size_t i = 0; i < batch.count; ++i) {
    Lanes g0, g1, g2;
    load((*nodes[i].gradient)[0], g0);
    load((*nodes[i].gradient)[1], g1);
    load((*nodes[i].gradient)[2], g2);
    Lanes force[3];
    for (std::size_t r = 0; r < 3; ++r) force[r] = P.m[r] * g0 + P.m[r + 3] * g1 + P.m[r + 6] * g2;
    scatterAdd(force, nodes[i].nodes.data(), forces);
  }
}

}  // namespace tissue_contact
