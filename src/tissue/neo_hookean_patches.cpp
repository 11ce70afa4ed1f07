#include "tissue/neo_hookean_patches.h"

#include "tissue/tet_elements.h"

namespace tissue_contact {

void NeoHookeanPatches::State::carry(StateArchive& archive) {
  archive.carry(tangent_deformations);
  carryRanges(archive, tangent_deformations.size(), moving);
  carryRanges(archive, tangent_deformations.size(), still);
}

NeoHookeanPatches::State NeoHookeanPatches::undeformed() const {
  const std::size_t count = patches_.batches.size();
  MatrixBatch identity{};
  for (const std::size_t i : {0, 4, 8}) identity[i].fill(1.0);
  State state;
  state.deformations.assign(count, identity);
  state.tangent_deformations = state.deformations;
  state.changed.assign(count, 0);
  state.moving = {{0, count}};
  return state;
}

void NeoHookeanPatches::addForces(const std::vector<BatchRange>& ranges, double tangent_change, State& state,
                                  KernelNodes& nodes) const {
  for (const BatchRange range : ranges) {
    addNeoHookeanPatchForces(patches_, range, tangent_change, nodes.x.data(), state.tangent_deformations,
                             state.deformations, state.changed, nodes.forces.data());
  }
}

bool NeoHookeanPatches::countChanged(const std::vector<BatchRange>& ranges, const State& state,
                                     std::size_t& changed) const {
  bool cancels = false;
  forEachMarked(ranges, state.changed, size(), [&](std::size_t batch, std::size_t lane) {
    ++changed;
    cancels = cancels || isLargeDeformation(state.tangent_deformations[batch], lane);
  });
  return cancels;
}

void NeoHookeanPatches::refresh(const std::vector<BatchRange>& ranges, bool rebuilds, State& state,
                                NeoHookeanStiffness& sum) const {
  forEachMarked(ranges, state.changed, size(), [&](std::size_t batch, std::size_t lane) {
    const std::size_t patch = batch * kLanes + lane;
    if (!rebuilds) addShare(patch, state.tangent_deformations[batch], -1.0, sum);
    for (std::size_t i = 0; i < 9; ++i) state.tangent_deformations[batch][i][lane] = state.deformations[batch][i][lane];
    if (!rebuilds) addShare(patch, state.deformations[batch], 1.0, sum);
  });
}

void NeoHookeanPatches::addStiffness(const State& state, NeoHookeanStiffness& sum) const {
  for (std::size_t p = 0; p < size(); ++p) addShare(p, state.tangent_deformations[p / kLanes], 1.0, sum);
}

void NeoHookeanPatches::addShare(std::size_t patch, const MatrixBatch& F, double sign, NeoHookeanStiffness& sum) const {
  sum.add({F,
           patch % kLanes,
           patches_.material(patch),
           {},
           sign * patches_.volume(patch),
           patches_.damping(patch),
           patches_.nodeCount(patch),
           patches_.slots(patch)},
          [&](std::size_t node) { return patches_.gradient(patch, node); });
}

double NeoHookeanPatches::energy(const NodalVectors& x) const {
  double energy = 0.0;
  for (std::size_t p = 0; p < size(); ++p) {
    energy += patches_.volume(p) * neoHookeanEnergy(patches_.deformationGradient(p, x), patches_.material(p));
  }
  return energy;
}

}  // namespace tissue_contact
