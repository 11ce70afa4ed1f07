/// @file
/// Room `tissue`, private: what the force kernels of patches share: four patches at a time, each an element of several nodes. Node
/// positions in, mean deformation gradients out; stresses in, nodal forces out.
#pragma once

#include "tissue/lanes.h"
#include "tissue/patch_elements.h"

namespace tissue_contact {

/// Mean F of each of four patches.
TISSUE_CONTACT_INLINE void meanGradients(const PatchNode* nodes, std::size_t count, const double* x, LaneMatrix& F) {
  Lanes x0, y0, z0;
  gather(nodes[0].nodes, x, 0, x0);
  gather(nodes[0].nodes, x, 1, y0);
  gather(nodes[0].nodes, x, 2, z0);
  for (Lanes& entry : F.m) entry = Lanes{};
  for (std::size_t i = 1; i < count; ++i) {
    Lanes dx, dy, dz;
    gather(nodes[i].nodes, x, 0, dx);
    gather(nodes[i].nodes, x, 1, dy);
    gather(nodes[i].nodes, x, 2, dz);
    dx -= x0;
    dy -= y0;
    dz -= z0;
    for (std::size_t c = 0; c < 3; ++c) {
      Lanes g;
      load(nodes[i].gradient[c], g);
      F.m[3 * c] += dx * g;
      F.m[3 * c + 1] += dy * g;
      F.m[3 * c + 2] += dz * g;
    }
  }
}

/// Forces -V P grad N of the stresses P of four patches, added to their nodes.
TISSUE_CONTACT_INLINE void addPatchStressForces(const PatchBatch& batch, const PatchNode* nodes, LaneMatrix& P,
                                                double* forces) {
  Lanes volume;
  load(batch.volume, volume);
  for (Lanes& entry : P.m) entry *= -volume;
  for (std::size_t i = 0; i < batch.count; ++i) {
    Lanes g0, g1, g2;
    load(nodes[i].gradient[0], g0);
    load(nodes[i].gradient[1], g1);
    load(nodes[i].gradient[2], g2);
    Lanes force[3];
    for (std::size_t r = 0; r < 3; ++r) force[r] = P.m[r] * g0 + P.m[r + 3] * g1 + P.m[r + 6] * g2;
    scatter(nodes[i].nodes, force, forces);
  }
}

}  // namespace tissue_contact
