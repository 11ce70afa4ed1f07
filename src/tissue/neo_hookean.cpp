#include "tissue/neo_hookean.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <utility>

#include "tissue/dilatation_patches.h"
#include "tissue/neo_hookean_kernel.h"
#include "tissue/neo_hookean_tangent.h"
#include "tissue/tet_elements.h"
#include "tissue_contact/tissue/tet_elasticity.h"

namespace tissue_contact {
namespace {

/// lambda and mu of the model from those of small strain. lambda > 0 for every Poisson's ratio above -1.
LameParameters modelParameters(const MaterialDescription& material) {
  const LameParameters lame = lameParameters(material);
  return {lame.lambda + 5.0 / 6.0 * lame.mu, 4.0 / 3.0 * lame.mu};
}

/// What elements keep for themselves where patches resist changes of volume.
LameParameters shapeParameters(const MaterialDescription& material) {
  const double mu = modelParameters(material).mu;
  return {mu / 8.0, mu};
}

// Squared Frobenius norm of F (3 at rest) beyond which an element is so stiff, as |F|^4, that taking its share out of
// the stiffness again would leave round-off behind that others notice.
constexpr double kLargeDeformation = 30.0;

InPatch inPatch(const TetElement& element, double pressure) { return {pressure, kFlatModulus * element.lame.mu}; }

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

/// Adds shares of elements to the stiffness, in the order in which they are given, four computed at a time.
class ElementStiffness {
 public:
  ElementStiffness(const TetElements& tets, Elasticity::State& state) : tets_(tets), state_(state) {}
  ~ElementStiffness() { addAll(); }  // those that did not make four
  ElementStiffness(const ElementStiffness&) = delete;
  ElementStiffness& operator=(const ElementStiffness&) = delete;

  /// @param F of all elements. @param sign -1: takes the share out.
  void add(std::size_t e, const std::vector<MatrixBatch>& F, const InPatch& patch, double sign) {
    const TetElement& element = tets_.elements[e];
    const std::size_t batch = e / kLanes;
    const std::size_t lane = e % kLanes;
    for (std::size_t i = 0; i < 9; ++i) {
      lanes_.F[i][count_] = F[batch][i][lane];
      lanes_.rest_inverse[i][count_] = tets_.batches[batch].rest_inverse[i][lane];
    }
    lanes_.volume[count_] = sign * element.volume;
    lanes_.lambda[count_] = element.lame.lambda;
    lanes_.mu[count_] = element.lame.mu;
    lanes_.pressure[count_] = patch.pressure;
    lanes_.flat_modulus[count_] = patch.flat_modulus;
    elements_[count_++] = e;
    if (count_ == kLanes) addAll();
  }

 private:
  void addAll() {
    if (count_ == 0) return;
    const unsigned char failed = computeTangents(lanes_);
    for (std::size_t lane = 0; lane < count_; ++lane) {
      addTo(elements_[lane], (failed >> lane & 1) != 0 ? simple(lane) : fast(lane));
    }
    count_ = 0;
  }

  TangentBlocks fast(std::size_t lane) const {
    TangentBlocks blocks;
    for (std::size_t k = 0; k < kTangentBlocks; ++k) blocks[k] = matrixInLane(lanes_.blocks[k], lane);
    return blocks;
  }

  TangentBlocks simple(std::size_t lane) const {
    const LameParameters& material = tets_.elements[elements_[lane]].lame;
    return tangentBlocks({matrixInLane(lanes_.F, lane), material, {lanes_.pressure[lane], lanes_.flat_modulus[lane]}},
                         tets_.shapeGradients(elements_[lane]), lanes_.volume[lane]);
  }

  void addTo(std::size_t e, const TangentBlocks& blocks) {
    const TetElement& element = tets_.elements[e];
    std::size_t place = 0;
    for (std::size_t n = 0; n < 4; ++n) {
      for (std::size_t m = n; m < 4; ++m, ++place) {
        const int slot = element.slots(n, m);
        if (slot >= 0) addBlock(n == m, slot, blocks[place], element.damping_s, state_.stiffness, state_.damping);
      }
    }
  }

  const TetElements& tets_;
  Elasticity::State& state_;
  TangentLanes lanes_ = {};  // lanes that nobody fills have numbers, too
  std::array<std::size_t, kLanes> elements_ = {};
  std::size_t count_ = 0;
};

}  // namespace

/// Deformation gradients are kept four elements at a time, column-major.
struct NeoHookean::DeformationState : State {
  std::vector<MatrixBatch> deformations;          ///< scratch: of each element at the last update
  std::vector<MatrixBatch> tangent_deformations;  ///< those `stiffness` was computed with
  std::vector<unsigned char> changed;             ///< scratch: elements to refresh, a bit each
  TetElements::Held held;
  KernelNodes nodes;  ///< scratch
  // Of patches; empty without:
  std::vector<ElementValues> volume_ratios;  ///< J at the last update
  std::vector<double> pressures;             ///< scratch, per patch: kappa (Jbar - 1), Pa
  std::vector<double> tangent_pressures;     ///< those `stiffness` was computed with
  std::vector<Vector3> tangent_gradients;    ///< likewise: b of every patch's nodes, patch after patch, m^2
  std::vector<unsigned char> stale;          ///< scratch, per patch: to be refreshed
  DilatationPatches::Held held_patches;

  void carry(StateArchive& archive) override {
    State::carry(archive);
    archive.carry(tangent_deformations);
    held.carry(archive, tangent_deformations.size(), stiffness.rows());
    archive.carry(volume_ratios);
    archive.carry(tangent_pressures);
    archive.carry(tangent_gradients);
    held_patches.carry(archive, pressures.size(), tangent_deformations.size());
  }
};

NeoHookean::NeoHookean(const NodalVectors& rest, const std::vector<Tetrahedron>& tetrahedra,
                       const std::vector<bool>& fixed, const ElementMaterials& materials,
                       const std::vector<int>& patch_of) {
  if (patch_of.empty()) {
    tets_ = std::make_unique<TetElements>(rest, tetrahedra, fixed, materials, modelParameters);
    return;
  }
  auto nodes = DilatationPatches::nodesOf(tetrahedra, patch_of);
  auto couplings = BlockPattern::forElements(nodes, fixed);
  tets_ = std::make_unique<TetElements>(rest, tetrahedra, fixed, materials, shapeParameters, std::move(couplings));
  patches_ = std::make_unique<DilatationPatches>(tetrahedra, fixed, materials, patch_of, std::move(nodes), *tets_);
}

NeoHookean::~NeoHookean() = default;

std::unique_ptr<NeoHookean::DeformationState> NeoHookean::undeformed() const {
  MatrixBatch identity{};
  for (const std::size_t i : {0, 4, 8}) identity[i].fill(1.0);
  auto state = std::make_unique<DeformationState>();
  state->deformations.assign(tets_->batches.size(), identity);
  state->tangent_deformations = state->deformations;
  state->changed.assign(tets_->batches.size(), 0);
  state->held = tets_->nothingHeld();
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
  NodalVectors forces = NodalVectors::Zero(3, x.cols());
  evaluate(x, state->held.moving, *state, forces);
  state->tangent_deformations = state->deformations;
  if (patches_) {
    patches_->meanPressures(tets_->batches, state->held.moving, state->volume_ratios, 1.0, false, state->held_patches,
                            state->tangent_pressures);
  }
  rebuildStiffness(*state);
  return state;
}

template <typename Call>
void NeoHookean::forEachChanged(const std::vector<BatchRange>& ranges, const DeformationState& state,
                                const Call& call) const {
  for (const BatchRange range : ranges) {
    for (std::size_t batch = range.begin; batch < range.end; ++batch) {
      if (state.changed[batch] == 0) continue;
      for (std::size_t lane = 0; lane < kLanes; ++lane) {
        const bool used = batch * kLanes + lane < tets_->elements.size();
        if (used && (state.changed[batch] >> lane & 1) != 0) call(batch, lane);
      }
    }
  }
}

void NeoHookean::rebuildStiffness(DeformationState& state) const {
  state.stiffness.setZero();
  state.damping.setZero();
  ElementStiffness elements(*tets_, state);
  for (std::size_t e = 0; e < tets_->elements.size(); ++e) {
    InPatch patch;
    if (patches_)
      patch = inPatch(tets_->elements[e], state.tangent_pressures[patches_->of_batch[e / kLanes][e % kLanes]]);
    elements.add(e, state.tangent_deformations, patch, 1.0);
  }
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
      const Eigen::Matrix<double, 3, 4> c = tets_->elements[e].volume * C * tets_->shapeGradients(e);
      for (int i = 0; i < 4; ++i) b[member.local[i]] += c.col(i);
    }
  }
  DilatationPatches::addStiffness(patch, sign > 0.0 ? b : nullptr, sign > 0.0 ? nullptr : b, state);
}

void NeoHookean::refreshStiffness(const std::vector<BatchRange>& ranges, DeformationState& state) const {
  std::size_t changes = 0;
  bool cancels = false;
  forEachChanged(ranges, state, [&](std::size_t batch, std::size_t lane) {
    ++changes;
    cancels = cancels || matrixInLane(state.tangent_deformations[batch], lane).squaredNorm() > kLargeDeformation;
  });
  const bool rebuild = cancels || 2 * changes > tets_->elements.size();
  ElementStiffness elements(*tets_, state);
  forEachChanged(ranges, state, [&](std::size_t batch, std::size_t lane) {
    const std::size_t e = batch * kLanes + lane;
    if (!rebuild) elements.add(e, state.tangent_deformations, {}, -1.0);
    for (std::size_t i = 0; i < 9; ++i) state.tangent_deformations[batch][i][lane] = state.deformations[batch][i][lane];
    if (!rebuild) elements.add(e, state.deformations, {}, 1.0);
  });
  if (rebuild) rebuildStiffness(state);
}

/// Those of which an element, or the mean, has changed, among the patches that are still, or those that are not.
void NeoHookean::markStalePatches(const std::vector<BatchRange>& ranges, bool still, DeformationState& state) const {
  for (std::size_t p = 0; p < patches_->patches.size(); ++p) {
    const double change = std::abs(state.pressures[p] - state.tangent_pressures[p]);
    const bool wanted = state.held_patches.isStill(p) == still;
    state.stale[p] = wanted && change > kTangentChange * patches_->patches[p].bulk ? 1 : 0;
  }
  forEachChanged(ranges, state, [&](std::size_t batch, std::size_t lane) {
    const int p = patches_->of_batch[batch][lane];
    if (state.held_patches.isStill(p) == still) state.stale[p] = 1;
  });
}

/// Whether the stale patches are many, or leave round-off behind.
bool NeoHookean::rebuildsFor(const DeformationState& state) const {
  const std::vector<DilatationPatches::Patch>& patches = patches_->patches;
  std::size_t changes = 0;
  bool cancels = false;
  for (std::size_t p = 0; p < patches.size(); ++p) {
    if (state.stale[p] == 0) continue;
    changes += patches[p].members.size();
    for (const DilatationPatches::Member& member : patches[p].members) {
      const std::size_t e = member.element;
      cancels =
          cancels || matrixInLane(state.tangent_deformations[e / kLanes], e % kLanes).squaredNorm() > kLargeDeformation;
    }
  }
  return cancels || 2 * changes > tets_->elements.size();
}

void NeoHookean::refreshPatches(DeformationState& state) const {
  const std::vector<DilatationPatches::Patch>& patches = patches_->patches;
  const bool rebuild = rebuildsFor(state);
  ElementStiffness elements(*tets_, state);
  for (std::size_t p = 0; p < patches.size(); ++p) {
    if (state.stale[p] == 0) continue;
    if (!rebuild) addPatchStiffness(p, -1.0, state);
    for (const DilatationPatches::Member& member : patches[p].members) {
      const std::size_t batch = member.element / kLanes;
      const std::size_t lane = member.element % kLanes;
      const TetElement& element = tets_->elements[member.element];
      const auto add = [&](const std::vector<MatrixBatch>& F, double pressure, double sign) {
        elements.add(member.element, F, inPatch(element, pressure), sign);
      };
      if (!rebuild) add(state.tangent_deformations, state.tangent_pressures[p], -1.0);
      for (std::size_t i = 0; i < 9; ++i)
        state.tangent_deformations[batch][i][lane] = state.deformations[batch][i][lane];
      state.changed[batch] &= static_cast<unsigned char>(~(1u << lane));
      if (!rebuild) add(state.deformations, state.pressures[p], 1.0);
    }
    state.tangent_pressures[p] = state.pressures[p];
    if (!rebuild) addPatchStiffness(p, 1.0, state);
  }
  if (rebuild) rebuildStiffness(state);
}

void NeoHookean::update(const NodalVectors& x, State& any_state, NodalVectors& forces) const {
  auto& state = static_cast<DeformationState&>(any_state);  // made by makeState()
  state.held.startForces(forces);
  evaluate(x, state.held.moving, state, forces);
  if (patches_) {
    addPatches(state.held_patches.pressed, false, state, forces);
  } else {
    refreshStiffness(state.held.moving, state);
  }
}

void NeoHookean::holdStill(const std::vector<bool>& still, const NodalVectors& x, State& any_state) const {
  auto& state = static_cast<DeformationState&>(any_state);
  tets_->split(still, state.held);
  evaluate(x, state.held.still, state, state.held.forces);
  if (patches_) {
    patches_->split(state.held, state.held_patches);
    addPatches(state.held.still, true, state, state.held.forces);
  } else {
    refreshStiffness(state.held.still, state);
  }
}

/// Adds what the elements of these batches do by themselves.
void NeoHookean::evaluate(const NodalVectors& x, const std::vector<BatchRange>& ranges, DeformationState& state,
                          NodalVectors& forces) const {
  state.nodes.begin(x, forces);
  const auto add = [&](BatchRange range, const auto& material) {
    addNeoHookeanForces(tets_->batches, range, material, kTangentChange, state.nodes.x.data(),
                        state.tangent_deformations, state.deformations, state.changed,
                        patches_ ? state.volume_ratios.data() : nullptr, state.nodes.forces.data());
  };
  for (const BatchRange range : ranges) {
    tets_->batch_materials.empty() ? add(range, tets_->material) : add(range, tets_->batch_materials);
  }
  unpad(state.nodes.forces, forces);
}

/// Adds the forces of the patches that are still, or of those that are not, and brings their stiffness up to date.
/// @param ranges batches that hold all their elements; what has changed in those of others stays marked.
void NeoHookean::addPatches(const std::vector<BatchRange>& ranges, bool still, DeformationState& state,
                            NodalVectors& forces) const {
  patches_->meanPressures(tets_->batches, ranges, state.volume_ratios, 1.0, still, state.held_patches, state.pressures);
  pad(forces, state.nodes.forces);
  for (const BatchRange range : ranges) {
    addCofactorForces(tets_->batches, range, state.deformations, patches_->of_batch, state.pressures,
                      state.nodes.forces.data());
  }
  unpad(state.nodes.forces, forces);
  markStalePatches(ranges, still, state);
  refreshPatches(state);
}

double NeoHookean::energy(const NodalVectors& x) const {
  double energy = 0.0;
  std::vector<double> changes(patches_ ? patches_->patches.size() : 0, 0.0);  // of volume, m^3
  for (std::size_t e = 0; e < tets_->elements.size(); ++e) {
    const TetElement& element = tets_->elements[e];
    const Matrix3 F = tets_->deformationGradient(e, x);
    const double I = F.squaredNorm();
    const double J = F.determinant();
    const LameParameters& material = element.lame;
    // lambda/2 ((J - alpha)^2 - (1 - alpha)^2) = (J - 1) (lambda/2 (J - 1) - 3/4 mu)
    energy += element.volume * (0.5 * material.mu * (I - 3.0 - std::log((I + 1.0) / 4.0)) +
                                (J - 1.0) * (0.5 * material.lambda * (J - 1.0) - 0.75 * material.mu));
    if (patches_) {
      const double flat = std::min(0.0, J - kFlat);
      energy += element.volume * 0.5 * kFlatModulus * material.mu * flat * flat;
      changes[patches_->of_batch[e / kLanes][e % kLanes]] += element.volume * (J - 1.0);
    }
  }
  for (std::size_t p = 0; p < changes.size(); ++p) {
    energy += 0.5 * patches_->patches[p].bulk * changes[p] * changes[p] / patches_->patches[p].volume;
  }
  return energy;
}

}  // namespace tissue_contact
