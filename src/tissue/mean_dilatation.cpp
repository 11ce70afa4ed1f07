#include "tissue/mean_dilatation.h"

#include <algorithm>
#include <utility>

#include "tissue/rotation_state.h"
#include "tissue/tet_elements.h"

namespace tissue_contact {

struct MeanDilatation::PatchState : RotationState {
  std::vector<Vector3> gradients;      ///< b of every patch's nodes, patch after patch, as in `stiffness`, m^2
  std::vector<Vector3> old_gradients;  ///< scratch, of one patch
  DilatationPatches::Held held_patches;
  std::vector<double> pressures;    ///< scratch, per patch: kappa tbar, Pa
  std::vector<int> turned_patches;  ///< scratch

  void carry(StateArchive& archive) override {
    RotationState::carry(archive);
    archive.carry(gradients);
    held_patches.carry(archive, pressures.size(), rotations.size());
  }
};

MeanDilatation::MeanDilatation(const NodalVectors& rest, const std::vector<Tetrahedron>& tetrahedra,
                               const std::vector<bool>& fixed, const ElementMaterials& materials,
                               const std::vector<int>& patch_of)
    : MeanDilatation(rest, tetrahedra, fixed, materials, patch_of, DilatationPatches::nodesOf(tetrahedra, patch_of)) {}

MeanDilatation::MeanDilatation(const NodalVectors& rest, const std::vector<Tetrahedron>& tetrahedra,
                               const std::vector<bool>& fixed, const ElementMaterials& materials,
                               const std::vector<int>& patch_of, std::vector<std::vector<int>> patch_nodes)
    : TetElasticity(materials.materials.at(0).model == ElasticModel::kCorotational,
                    std::make_unique<TetElements>(rest, tetrahedra, fixed, materials, deviatoricParameters,
                                                  BlockPattern::forElements(patch_nodes, fixed))),
      corotational_(materials.materials.at(0).model == ElasticModel::kCorotational),
      averaged_(tetrahedra, fixed, materials, patch_of, std::move(patch_nodes), tets()) {}

MeanDilatation::~MeanDilatation() = default;

std::unique_ptr<Elasticity::State> MeanDilatation::makeState() const { return makeState(nullptr); }

std::unique_ptr<Elasticity::State> MeanDilatation::makeStateAt(const NodalVectors& x) const { return makeState(&x); }

std::unique_ptr<Elasticity::State> MeanDilatation::makeState(const NodalVectors* x) const {
  auto state = std::make_unique<PatchState>();
  prepare(x, *state);
  state->gradients.assign(averaged_.nodeCount(), Vector3::Zero());
  for (const Patch& patch : averaged_.patches) {
    addGradients(patch, *state, &state->gradients[patch.first]);
    DilatationPatches::addStiffness(patch, &state->gradients[patch.first], nullptr, *state);
  }
  state->old_gradients.resize(averaged_.most_nodes);
  state->held_patches = averaged_.nothingHeld();
  state->pressures.resize(averaged_.patches.size());
  if (corotational_) {
    state->traces.resize(tets().batches.size());
    state->turned_patches.reserve(tets().batches.size() * kLanes);
  }
  return state;
}

/// b of the patch's nodes: sum of V R grad N.
void MeanDilatation::addGradients(const Patch& patch, const RotationState& state, Vector3* gradients) const {
  for (const DilatationPatches::Member& member : patch.members) {
    Eigen::Matrix<double, 3, 4> c = tets().shapeGradients(member.element);
    if (corotational_) {
      const auto& q = state.rotations[member.element / kLanes];
      const std::size_t lane = member.element % kLanes;
      c = Quaternion(q[0][lane], q[1][lane], q[2][lane], q[3][lane]).normalized().toRotationMatrix() * c;
    }
    const double volume = tets().elements[member.element].volume;
    for (int i = 0; i < 4; ++i) gradients[member.local[i]] += volume * c.col(i);
  }
}

/// Mean of tr(R'F) - 3 over the patch.
double MeanDilatation::dilatation(const Patch& patch, const Vector3* gradients, const NodalVectors& x) {
  double sum = 0.0;
  // The gradients sum to zero, so positions may be taken from the first node: no loss of digits far from the origin.
  const Vector3 origin = x.col(patch.nodes.front());
  for (std::size_t i = 0; i < patch.nodes.size(); ++i) sum += gradients[i].dot(x.col(patch.nodes[i]) - origin);
  return sum / patch.volume - 3.0;
}

/// Brings the share of patches in line with the rotations of their elements, wherever TetElasticity has just refreshed that
/// of an element in these batches.
void MeanDilatation::refreshStiffness(const std::vector<BatchRange>& ranges, PatchState& state) const {
  std::vector<int>& turned = state.turned_patches;
  turned.clear();
  for (const BatchRange range : ranges) {
    for (std::size_t b = range.begin; b < range.end; ++b) {
      for (std::size_t lane = 0; lane < kLanes && state.turned[b] >> lane != 0; ++lane) {
        const bool is_element = b * kLanes + lane < tets().elements.size();
        if (is_element && (state.turned[b] >> lane & 1) != 0) turned.push_back(averaged_.of_batch[b][lane]);
      }
    }
  }
  std::sort(turned.begin(), turned.end());
  turned.erase(std::unique(turned.begin(), turned.end()), turned.end());
  for (const int p : turned) {
    const Patch& patch = averaged_.patches[p];
    Vector3* const gradients = &state.gradients[patch.first];
    std::copy_n(gradients, patch.nodes.size(), state.old_gradients.data());
    std::fill_n(gradients, patch.nodes.size(), Vector3::Zero());
    addGradients(patch, state, gradients);
    DilatationPatches::addStiffness(patch, gradients, state.old_gradients.data(), state);
  }
}

/// Adds the forces of the patches that are still, or of those that are not.
/// @param ranges batches that hold all their elements.
void MeanDilatation::addForces(const NodalVectors& x, const std::vector<BatchRange>& ranges, bool still,
                               PatchState& state, NodalVectors& forces) const {
  if (!corotational_) {
    for (std::size_t p = 0; p < averaged_.patches.size(); ++p) {
      if (state.held_patches.isStill(p) != still) continue;
      const Patch& patch = averaged_.patches[p];
      const Vector3* const gradients = &state.gradients[patch.first];
      const double pressure = patch.bulk * dilatation(patch, gradients, x);
      for (std::size_t i = 0; i < patch.nodes.size(); ++i) forces.col(patch.nodes[i]) -= pressure * gradients[i];
    }
    return;
  }
  averaged_.meanPressures(tets().batches, ranges, state.traces, 3.0, still, state.held_patches, state.pressures);
  for (const BatchRange range : ranges) {
    addPressureForces(tets().batches, range, state.rotations, averaged_.of_batch, state.pressures, forces.data());
  }
}

void MeanDilatation::update(const NodalVectors& x, State& any_state, NodalVectors& forces) const {
  TetElasticity::update(x, any_state, forces);
  auto& state = static_cast<PatchState&>(any_state);  // made by makeState()
  if (corotational_) refreshStiffness(state.held.moving, state);
  addForces(x, state.held_patches.pressed, false, state, forces);
}

void MeanDilatation::holdStill(const std::vector<bool>& still, const NodalVectors& x, State& any_state) const {
  TetElasticity::holdStill(still, x, any_state);
  auto& state = static_cast<PatchState&>(any_state);
  if (corotational_) refreshStiffness(state.held.still, state);
  averaged_.split(state.held, state.held_patches);
  if (!state.held.still.empty()) addForces(x, state.held.still, true, state, state.held.forces);
}

double MeanDilatation::energy(const NodalVectors& x) const {
  PatchState state;
  if (corotational_) {
    state.rotations.resize(tets().batches.size());
    for (std::size_t e = 0; e < tets().elements.size(); ++e) {
      const Quaternion q = nearestRotation(tets().deformationGradient(e, x), Quaternion::Identity());
      const double parts[4] = {q.w(), q.x(), q.y(), q.z()};
      for (std::size_t i = 0; i < 4; ++i) state.rotations[e / kLanes][i][e % kLanes] = parts[i];
    }
  }
  double energy = TetElasticity::energy(x);
  std::vector<Vector3> gradients(averaged_.most_nodes);
  for (const Patch& patch : averaged_.patches) {
    std::fill(gradients.begin(), gradients.end(), Vector3::Zero());
    addGradients(patch, state, gradients.data());
    const double mean = dilatation(patch, gradients.data(), x);
    energy += 0.5 * patch.bulk * patch.volume * mean * mean;
  }
  return energy;
}

}  // namespace tissue_contact
