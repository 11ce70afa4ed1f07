#include "tissue/neo_hookean.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <utility>

#include "tissue/dilatation_patches.h"
#include "tissue/neo_hookean_kernel.h"
#include "tissue/neo_hookean_patches.h"
#include "tissue/neo_hookean_stiffness.h"
#include "tissue/tet_elements.h"
#include "tissue_contact/tissue/tet_elasticity.h"

namespace tissue_contact {
namespace {

/// lambda and mu of the model from those of small strain. lambda > 0 for every Poisson's ratio above -1.
LameParameters modelParameters(const MaterialDescription& material) {
  const LameParameters lame = lameParameters(material);
  return {lame.lambda + 5.0 / 6.0 * lame.mu, 4.0 / 3.0 * lame.mu};
}

/// A share of them. @param without_volume patches resist changes of volume: what is left keeps the shape.
TetElements::Lame shareOfParameters(double share, bool without_volume) {
  return [=](const MaterialDescription& material) -> LameParameters {
    const LameParameters all = modelParameters(material);
    return {share * (without_volume ? all.mu / 8.0 : all.lambda), share * all.mu};
  };
}

/// dJ/dF.
Matrix3 cofactors(const Matrix3& F) {
  Matrix3 C;
  for (int c = 0; c < 3; ++c) C.col(c) = F.col((c + 1) % 3).cross(F.col((c + 2) % 3));
  return C;
}

Matrix3 matrixInLane(const MatrixBatch& batch, std::size_t lane) {
  Matrix3 matrix;
  for (std::size_t i = 0; i < 9; ++i) matrix.data()[i] = batch[i][lane];
  return matrix;
}

}  // namespace

/// Deformation gradients are kept four elements at a time, column-major.
struct NeoHookean::DeformationState : State {
  std::vector<MatrixBatch> deformations;          ///< of each element at its last update
  std::vector<MatrixBatch> tangent_deformations;  ///< those `stiffness` was computed with
  std::vector<unsigned char> changed;             ///< scratch: elements to refresh, a bit each
  TetElements::Held held;
  NeoHookeanPatches::State shares;  ///< of patches that are elements
  KernelNodes nodes;                ///< scratch
  NeoHookeanStiffness::Scratch scratch;
  // Of patches that average the change of volume; empty without:
  std::vector<ElementValues> volume_ratios;  ///< J at the last update
  std::vector<double> pressures;             ///< scratch, per patch: kappa (Jbar - 1), Pa
  std::vector<double> tangent_pressures;     ///< those `stiffness` was computed with
  std::vector<Vector3> tangent_gradients;    ///< likewise: b of every patch's nodes, patch after patch, m^2
  std::vector<unsigned char> stale;          ///< scratch, per patch: to be refreshed
  DilatationPatches::Held held_patches;

  explicit DeformationState(std::size_t most_nodes) : scratch(most_nodes) {}

  void carry(StateArchive& archive) override {
    State::carry(archive);
    archive.carry(tangent_deformations);
    held.carry(archive, tangent_deformations.size(), stiffness.rows());
    shares.carry(archive);
    archive.carry(volume_ratios);
    archive.carry(tangent_pressures);
    archive.carry(tangent_gradients);
    if (!pressures.empty()) archive.carry(deformations);  // patches read those of elements at rest
    held_patches.carry(archive, pressures.size(), tangent_deformations.size());
  }
};

NeoHookean::NeoHookean(const NodalVectors& rest, const std::vector<Tetrahedron>& tetrahedra,
                       const std::vector<bool>& fixed, const ElementMaterials& materials,
                       const std::vector<int>& patch_of, const Averages& averages) {
  if (patch_of.empty()) {
    tets_ = std::make_unique<TetElements>(rest, tetrahedra, fixed, materials, modelParameters);
    return;
  }
  auto nodes = DilatationPatches::nodesOf(tetrahedra, patch_of);
  auto couplings = BlockPattern::forElements(nodes, fixed);
  const double own = 1.0 - averages.share;
  flat_modulus_ = kFlatModulus / own;
  tets_ = std::make_unique<TetElements>(rest, tetrahedra, fixed, materials, shareOfParameters(own, averages.dilatation),
                                        std::move(couplings));
  auto patches = std::make_unique<DilatationPatches>(tetrahedra, fixed, materials, patch_of, std::move(nodes), *tets_);
  if (averages.share > 0.0) {
    shares_ = std::make_unique<NeoHookeanPatches>(
        PatchElements(*patches, *tets_, materials, shareOfParameters(averages.share, averages.dilatation)));
  }
  if (averages.dilatation) patches_ = std::move(patches);
}

NeoHookean::~NeoHookean() = default;

std::unique_ptr<NeoHookean::DeformationState> NeoHookean::undeformed() const {
  MatrixBatch identity{};
  for (const std::size_t i : {0, 4, 8}) identity[i].fill(1.0);
  auto state = std::make_unique<DeformationState>(shares_ ? std::max<std::size_t>(4, shares_->mostNodes()) : 4);
  state->deformations.assign(tets_->batches.size(), identity);
  state->tangent_deformations = state->deformations;
  state->changed.assign(tets_->batches.size(), 0);
  state->held = tets_->nothingHeld();
  if (shares_) state->shares = shares_->undeformed();
  if (patches_) {
    state->volume_ratios.resize(tets_->batches.size());
    state->pressures.assign(patches_->patches.size(), 0.0);
    state->tangent_pressures = state->pressures;
    state->tangent_gradients.resize(patches_->nodeCount());
    state->stale.assign(patches_->patches.size(), 1);
    state->held_patches = patches_->nothingHeld();
  }
  tets_->prepare(*state);
  state->nodes.x.resize(static_cast<std::size_t>(state->stiffness.rows()));
  state->nodes.forces.resize(state->nodes.x.size());
  return state;
}

std::unique_ptr<Elasticity::State> NeoHookean::makeState() const {
  auto state = undeformed();
  rebuildStiffness(*state);
  return state;
}

std::unique_ptr<Elasticity::State> NeoHookean::makeStateAt(const NodalVectors& x) const {
  auto state = undeformed();
  state->nodes.begin(x, {});
  evaluate(state->held.moving, *state);
  if (shares_) shares_->addForces(state->shares.moving, kTangentChange, state->shares, state->nodes);
  state->tangent_deformations = state->deformations;
  state->shares.tangent_deformations = state->shares.deformations;
  if (patches_) {
    patches_->meanPressures(tets_->batches, state->held.moving, state->volume_ratios, 1.0, false, state->held_patches,
                            state->tangent_pressures);
  }
  rebuildStiffness(*state);
  return state;
}

/// Adds an element's share. @param F of all elements. @param sign -1: takes it out.
void NeoHookean::addShare(std::size_t e, const std::vector<MatrixBatch>& F, double pressure, double sign,
                          NeoHookeanStiffness& sum) const {
  const TetElement element = tets_->element(e);
  const InPatch patch = {pressure, flat_modulus_ * element.lame.mu};
  const Eigen::Matrix<double, 3, 4> gradients = tets_->shapeGradients(e);
  sum.add({F[e / kLanes], e % kLanes, element.lame, patch, sign * element.volume, element.damping_s, 4,
           element.slots.rowByRow()},
          [&](std::size_t node) -> Vector3 { return gradients.col(static_cast<Eigen::Index>(node)); });
}

void NeoHookean::rebuildStiffness(DeformationState& state) const {
  state.stiffness.setZero();
  state.damping.setZero();
  NeoHookeanStiffness sum(state.scratch, state);
  for (std::size_t e = 0; e < tets_->size(); ++e) {
    const double pressure = patches_ ? state.tangent_pressures[patches_->of_batch[e / kLanes][e % kLanes]] : 0.0;
    addShare(e, state.tangent_deformations, pressure, 1.0, sum);
  }
  if (shares_) shares_->addStiffness(state.shares, sum);
  for (std::size_t p = 0; patches_ && p < patches_->patches.size(); ++p) addPatchStiffness(p, 1.0, state);
}

/// The patch's kappa/V b b', b being computed anew when it is added.
void NeoHookean::addPatchStiffness(std::size_t p, double sign, DeformationState& state) const {
  const DilatationPatches::Patch& patch = patches_->patches[p];
  Vector3* const b = &state.tangent_gradients[patch.first];
  if (sign > 0.0) {
    std::fill_n(b, patch.nodes.size(), Vector3(0.0, 0.0, 0.0));
    for (const DilatationPatches::Member& member : patch.members) {
      const std::size_t e = member.element;
      const Matrix3 C = cofactors(matrixInLane(state.tangent_deformations[e / kLanes], e % kLanes));
      const Eigen::Matrix<double, 3, 4> c = tets_->volume(e) * C * tets_->shapeGradients(e);
      for (int i = 0; i < 4; ++i) b[member.local[i]] += c.col(i);
    }
  }
  DilatationPatches::addStiffness(patch, sign > 0.0 ? b : nullptr, sign > 0.0 ? nullptr : b, state);
}

/// Shares of elements and patches that have changed, among those that are still, or those that are not.
void NeoHookean::refreshStiffness(bool still, DeformationState& state) const {
  const std::vector<BatchRange>& elements = still ? state.held.still : state.held.moving;
  const std::vector<BatchRange>& patches = still ? state.shares.still : state.shares.moving;
  const bool rebuilds = rebuildsFor(elements, patches, state);
  {
    NeoHookeanStiffness sum(state.scratch, state);
    patches_ ? refreshPatches(rebuilds, state, sum) : refreshElements(elements, rebuilds, state, sum);
    if (shares_) shares_->refresh(patches, rebuilds, state.shares, sum);
  }
  if (rebuilds) rebuildStiffness(state);
}

void NeoHookean::refreshElements(const std::vector<BatchRange>& ranges, bool rebuilds, DeformationState& state,
                                 NeoHookeanStiffness& sum) const {
  forEachMarked(ranges, state.changed, tets_->size(), [&](std::size_t batch, std::size_t lane) {
    const std::size_t e = batch * kLanes + lane;
    if (!rebuilds) addShare(e, state.tangent_deformations, 0.0, -1.0, sum);
    for (std::size_t i = 0; i < 9; ++i) state.tangent_deformations[batch][i][lane] = state.deformations[batch][i][lane];
    if (!rebuilds) addShare(e, state.deformations, 0.0, 1.0, sum);
  });
}

/// Those of which an element, or the mean, has changed, among the patches that are still, or those that are not.
void NeoHookean::markStalePatches(const std::vector<BatchRange>& ranges, bool still, DeformationState& state) const {
  for (std::size_t p = 0; p < patches_->patches.size(); ++p) {
    const double change = std::abs(state.pressures[p] - state.tangent_pressures[p]);
    const bool wanted = state.held_patches.isStill(p) == still;
    state.stale[p] = wanted && change > kTangentChange * patches_->patches[p].bulk ? 1 : 0;
  }
  forEachMarked(ranges, state.changed, tets_->size(), [&](std::size_t batch, std::size_t lane) {
    const int p = patches_->of_batch[batch][lane];
    if (state.held_patches.isStill(p) == still) state.stale[p] = 1;
  });
}

/// Whether those that have changed are many, or leave round-off behind.
bool NeoHookean::rebuildsFor(const std::vector<BatchRange>& elements, const std::vector<BatchRange>& patches,
                             const DeformationState& state) const {
  std::size_t changes = 0;
  bool cancels = shares_ && shares_->countChanged(patches, state.shares, changes);
  const auto count = [&](std::size_t batch, std::size_t lane) {
    ++changes;
    cancels = cancels || isLargeDeformation(state.tangent_deformations[batch], lane);
  };
  if (!patches_) forEachMarked(elements, state.changed, tets_->size(), count);
  for (std::size_t p = 0; patches_ && p < patches_->patches.size(); ++p) {
    if (state.stale[p] == 0) continue;
    for (const DilatationPatches::Member& member : patches_->patches[p].members) {
      count(member.element / kLanes, member.element % kLanes);
    }
  }
  return cancels || 2 * changes > tets_->size() + (shares_ ? shares_->size() : 0);
}

void NeoHookean::refreshPatches(bool rebuilds, DeformationState& state, NeoHookeanStiffness& sum) const {
  const std::vector<DilatationPatches::Patch>& patches = patches_->patches;
  for (std::size_t p = 0; p < patches.size(); ++p) {
    if (state.stale[p] == 0) continue;
    if (!rebuilds) addPatchStiffness(p, -1.0, state);
    for (const DilatationPatches::Member& member : patches[p].members) {
      const std::size_t e = member.element;
      const std::size_t batch = e / kLanes;
      const std::size_t lane = e % kLanes;
      if (!rebuilds) addShare(e, state.tangent_deformations, state.tangent_pressures[p], -1.0, sum);
      for (std::size_t i = 0; i < 9; ++i)
        state.tangent_deformations[batch][i][lane] = state.deformations[batch][i][lane];
      state.changed[batch] &= static_cast<unsigned char>(~(1u << lane));
      if (!rebuilds) addShare(e, state.deformations, state.pressures[p], 1.0, sum);
    }
    state.tangent_pressures[p] = state.pressures[p];
    if (!rebuilds) addPatchStiffness(p, 1.0, state);
  }
}

void NeoHookean::update(const NodalVectors& x, State& any_state, NodalVectors& forces) const {
  auto& state = static_cast<DeformationState&>(any_state);  // made by makeState()
  state.nodes.begin(x, state.held.forces);
  evaluate(state.held.moving, state);
  if (shares_) shares_->addForces(state.shares.moving, kTangentChange, state.shares, state.nodes);
  if (patches_) addPatches(state.held_patches.pressed, false, state);
  unpad(state.nodes.forces, forces);
  refreshStiffness(false, state);
}

void NeoHookean::holdStill(const std::vector<bool>& still, const NodalVectors& x, State& any_state) const {
  auto& state = static_cast<DeformationState&>(any_state);
  tets_->split(still, state.held);
  state.nodes.begin(x, {});
  evaluate(state.held.still, state);
  if (shares_) {
    shares_->split(still, state.shares);
    shares_->addForces(state.shares.still, kTangentChange, state.shares, state.nodes);
  }
  if (patches_) {
    patches_->split(state.held, state.held_patches);
    addPatches(state.held.still, true, state);
  }
  unpad(state.nodes.forces, state.held.forces);
  refreshStiffness(true, state);
}

/// Adds what the elements of these batches do by themselves.
void NeoHookean::evaluate(const std::vector<BatchRange>& ranges, DeformationState& state) const {
  const auto add = [&](BatchRange range, const auto& material) {
    addNeoHookeanForces(tets_->batches, range, material, kTangentChange, state.nodes.x.data(),
                        state.tangent_deformations, state.deformations, state.changed, flat_modulus_,
                        patches_ ? state.volume_ratios.data() : nullptr, state.nodes.forces.data());
  };
  for (const BatchRange range : ranges) {
    tets_->batch_materials.empty() ? add(range, tets_->material) : add(range, tets_->batch_materials);
  }
}

/// Adds the forces of the patches' pressure, of those that are still, or of those that are not, and marks those whose stiffness is stale.
/// @param ranges batches that hold all their elements; what has changed in those of others stays marked.
void NeoHookean::addPatches(const std::vector<BatchRange>& ranges, bool still, DeformationState& state) const {
  patches_->meanPressures(tets_->batches, ranges, state.volume_ratios, 1.0, still, state.held_patches, state.pressures);
  for (const BatchRange range : ranges) {
    addCofactorForces(tets_->batches, range, state.deformations, patches_->of_batch, state.pressures,
                      state.nodes.forces.data());
  }
  markStalePatches(ranges, still, state);
}

double NeoHookean::energy(const NodalVectors& x) const {
  double energy = shares_ ? shares_->energy(x) : 0.0;
  std::vector<double> changes(patches_ ? patches_->patches.size() : 0, 0.0);  // of volume, m^3
  for (std::size_t e = 0; e < tets_->size(); ++e) {
    const TetElement element = tets_->element(e);
    const Matrix3 F = tets_->deformationGradient(e, x);
    const double J = F.determinant();
    const double flat = std::min(0.0, J - kFlat);
    energy +=
        element.volume * (neoHookeanEnergy(F, element.lame) + 0.5 * flat_modulus_ * element.lame.mu * flat * flat);
    if (!patches_) continue;
    changes[patches_->of_batch[e / kLanes][e % kLanes]] += element.volume * (J - 1.0);
  }
  for (std::size_t p = 0; p < changes.size(); ++p) {
    energy += 0.5 * patches_->patches[p].bulk * changes[p] * changes[p] / patches_->patches[p].volume;
  }
  return energy;
}

}  // namespace tissue_contact
