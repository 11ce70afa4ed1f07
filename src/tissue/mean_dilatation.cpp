#include "tissue/mean_dilatation.h"

#include <algorithm>
#include <map>
#include <stdexcept>
#include <string>
#include <utility>

#include "tissue/rotation_state.h"
#include "tissue/tet_elements.h"

namespace tissue_contact {

struct MeanDilatation::Patch {
  struct Member {
    std::size_t element;
    std::array<int, 4> local;  ///< its nodes' places in `nodes`
  };
  std::vector<Member> members;
  std::vector<int> nodes;
  std::vector<int> slots;  ///< of node pairs, row by row, as BlockSlots
  double volume = 0.0;     ///< m^3
  double bulk = 0.0;       ///< mean over the volume, Pa
  double damping_s = 0.0;  ///< likewise
  std::size_t first = 0;   ///< of its nodes in PatchState::gradients
};

struct MeanDilatation::PatchState : RotationState {
  std::vector<Vector3> gradients;      ///< b of every patch's nodes, patch after patch, as in `stiffness`, m^2
  std::vector<Vector3> old_gradients;  ///< scratch, of one patch; zero before the first update
  std::vector<bool> still;             ///< per patch: its forces are among the held ones; empty: none is
  std::vector<BatchRange> pressed;     ///< batches with elements of the other patches
  std::vector<double> pressures;       ///< scratch, per patch: kappa tbar, Pa
  std::vector<int> turned_patches;     ///< scratch
};

namespace {

double bulkModulus(const MaterialDescription& material) {
  const LameParameters lame = lameParameters(material);
  return lame.lambda + 2.0 / 3.0 * lame.mu;
}

/// Nodes of every patch, ascending.
std::vector<std::vector<int>> patchNodes(const std::vector<Tetrahedron>& tetrahedra, const std::vector<int>& patch_of) {
  if (patch_of.size() != tetrahedra.size()) {
    throw std::invalid_argument("mean dilatation: " + std::to_string(patch_of.size()) + " patch numbers given for " +
                                std::to_string(tetrahedra.size()) + " tetrahedra");
  }
  std::vector<std::vector<int>> nodes;
  for (std::size_t e = 0; e < tetrahedra.size(); ++e) {
    if (patch_of[e] < 0) throw std::invalid_argument("mean dilatation: patch number " + std::to_string(patch_of[e]));
    nodes.resize(std::max(nodes.size(), static_cast<std::size_t>(patch_of[e]) + 1));
    nodes[patch_of[e]].insert(nodes[patch_of[e]].end(), tetrahedra[e].begin(), tetrahedra[e].end());
  }
  for (std::vector<int>& patch : nodes) {
    std::sort(patch.begin(), patch.end());
    patch.erase(std::unique(patch.begin(), patch.end()), patch.end());
  }
  return nodes;
}

}  // namespace

MeanDilatation::MeanDilatation(const NodalVectors& rest, const std::vector<Tetrahedron>& tetrahedra,
                               const std::vector<bool>& fixed, const ElementMaterials& materials,
                               const std::vector<int>& patch_of)
    : TetElasticity(materials.materials.at(0).model == ElasticModel::kCorotational,
                    std::make_unique<TetElements>(rest, tetrahedra, fixed, materials, deviatoricParameters,
                                                  BlockMatrix::forElements(patchNodes(tetrahedra, patch_of), fixed))),
      corotational_(materials.materials.at(0).model == ElasticModel::kCorotational) {
  const std::vector<std::vector<int>> nodes = patchNodes(tetrahedra, patch_of);
  patches_.resize(nodes.size());
  for (std::size_t e = 0; e < tetrahedra.size(); ++e) {
    Patch& patch = patches_[patch_of[e]];
    const std::vector<int>& of_patch = nodes[patch_of[e]];
    Patch::Member& member = patch.members.emplace_back(Patch::Member{e, {}});
    for (int i = 0; i < 4; ++i) {
      const auto at = std::lower_bound(of_patch.begin(), of_patch.end(), tetrahedra[e][i]);
      member.local[i] = static_cast<int>(at - of_patch.begin());
    }
    const double volume = tets().elements[e].volume;
    patch.volume += volume;
    patch.bulk += volume * bulkModulus(materials.of(e));
    patch.damping_s += volume * materials.dampingOf(e);
  }
  for (std::size_t e = 0; e < kLanes * tets().batches.size(); ++e) {
    if (e % kLanes == 0) patch_of_.emplace_back();
    patch_of_.back()[e % kLanes] = patch_of[std::min(e, patch_of.size() - 1)];
  }
  std::size_t first = 0;
  for (std::size_t p = 0; p < patches_.size(); ++p) {
    Patch& patch = patches_[p];
    if (patch.members.empty()) throw std::invalid_argument("mean dilatation: patch " + std::to_string(p) + " is empty");
    patch.bulk /= patch.volume;
    patch.damping_s /= patch.volume;
    patch.nodes = nodes[p];
    patch.first = first;
    first += patch.nodes.size();
    most_nodes_ = std::max(most_nodes_, patch.nodes.size());
    for (const int a : patch.nodes) {
      for (const int b : patch.nodes) patch.slots.push_back(slotOf(tets().pattern, fixed, a, b));
    }
  }
}

MeanDilatation::~MeanDilatation() = default;

std::unique_ptr<Elasticity::State> MeanDilatation::makeState() const {
  auto state = std::make_unique<PatchState>();
  prepare(*state);
  state->gradients.assign(patches_.back().first + patches_.back().nodes.size(), Vector3::Zero());
  state->old_gradients.assign(most_nodes_, Vector3::Zero());
  for (const Patch& patch : patches_) {
    addGradients(patch, *state, &state->gradients[patch.first]);
    addStiffness(patch, &state->gradients[patch.first], state->old_gradients.data(), *state);
  }
  state->pressed = {{0, tets().batches.size()}};
  state->pressures.resize(patches_.size());
  if (corotational_) {
    state->traces.resize(tets().batches.size());
    state->turned_patches.reserve(tets().batches.size() * kLanes);
  }
  return state;
}

/// b of the patch's nodes: sum of V R grad N.
void MeanDilatation::addGradients(const Patch& patch, const RotationState& state, Vector3* gradients) const {
  for (const Patch::Member& member : patch.members) {
    const TetElement& element = tets().elements[member.element];
    Eigen::Matrix<double, 3, 4> c = shapeGradients(element.rest_inverse);
    if (corotational_) {
      const auto& q = state.rotations[member.element / kLanes];
      const std::size_t lane = member.element % kLanes;
      c = Quaternion(q[0][lane], q[1][lane], q[2][lane], q[3][lane]).normalized().toRotationMatrix() * c;
    }
    for (int i = 0; i < 4; ++i) gradients[member.local[i]] += element.volume * c.col(i);
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

/// Puts kappa/V b b' of these gradients in the place of that of `old`, in one pass over the blocks.
void MeanDilatation::addStiffness(const Patch& patch, const Vector3* gradients, const Vector3* old, State& state) {
  const double scale = patch.bulk / patch.volume;
  const std::size_t count = patch.nodes.size();
  for (std::size_t i = 0; i < count; ++i) {
    const Vector3 scaled = scale * gradients[i];
    const Vector3 old_scaled = scale * old[i];
    for (std::size_t j = i; j < count; ++j) {
      const int slot = patch.slots[i * count + j];
      if (slot < 0) continue;
      const Matrix3 block = scaled * gradients[j].transpose() - old_scaled * old[j].transpose();
      addBlock(i == j, slot, block, patch.damping_s, state.stiffness, state.damping);
      if (i == j) continue;
      addBlock(false, patch.slots[j * count + i], block.transpose(), patch.damping_s, state.stiffness, state.damping);
    }
  }
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
        if (is_element && (state.turned[b] >> lane & 1) != 0) turned.push_back(patch_of_[b][lane]);
      }
    }
  }
  std::sort(turned.begin(), turned.end());
  turned.erase(std::unique(turned.begin(), turned.end()), turned.end());
  for (const int p : turned) {
    const Patch& patch = patches_[p];
    Vector3* const gradients = &state.gradients[patch.first];
    std::copy_n(gradients, patch.nodes.size(), state.old_gradients.data());
    std::fill_n(gradients, patch.nodes.size(), Vector3::Zero());
    addGradients(patch, state, gradients);
    addStiffness(patch, gradients, state.old_gradients.data(), state);
  }
}

/// Adds the forces of the patches that are still, or of those that are not.
/// @param ranges batches that hold all their elements.
void MeanDilatation::addForces(const NodalVectors& x, const std::vector<BatchRange>& ranges, bool still,
                               PatchState& state, NodalVectors& forces) const {
  const auto wanted = [&](std::size_t p) { return state.still.empty() ? !still : state.still[p] == still; };
  if (!corotational_) {
    for (std::size_t p = 0; p < patches_.size(); ++p) {
      if (!wanted(p)) continue;
      const Patch& patch = patches_[p];
      const Vector3* const gradients = &state.gradients[patch.first];
      const double pressure = patch.bulk * dilatation(patch, gradients, x);
      for (std::size_t i = 0; i < patch.nodes.size(); ++i) forces.col(patch.nodes[i]) -= pressure * gradients[i];
    }
    return;
  }
  std::fill(state.pressures.begin(), state.pressures.end(), 0.0);
  for (const BatchRange range : ranges) {
    for (std::size_t b = range.begin; b < range.end; ++b) {
      for (std::size_t lane = 0; lane < kLanes; ++lane) {
        state.pressures[patch_of_[b][lane]] += tets().batches[b].volume[lane] * (state.traces[b][lane] - 3.0);
      }
    }
  }
  for (std::size_t p = 0; p < patches_.size(); ++p) {
    state.pressures[p] = wanted(p) ? patches_[p].bulk / patches_[p].volume * state.pressures[p] : 0.0;
  }
  for (const BatchRange range : ranges) {
    addPressureForces(tets().batches, range, state.rotations, patch_of_, state.pressures, forces.data());
  }
}

void MeanDilatation::update(const NodalVectors& x, State& any_state, NodalVectors& forces) const {
  TetElasticity::update(x, any_state, forces);
  auto& state = static_cast<PatchState&>(any_state);  // made by makeState()
  if (corotational_) refreshStiffness(state.held.moving, state);
  addForces(x, state.pressed, false, state, forces);
}

void MeanDilatation::holdStill(const std::vector<bool>& still, const NodalVectors& x, State& any_state) const {
  TetElasticity::holdStill(still, x, any_state);
  auto& state = static_cast<PatchState&>(any_state);
  if (corotational_) refreshStiffness(state.held.still, state);
  state.still.clear();
  state.pressed = {{0, tets().batches.size()}};
  if (state.held.still.empty()) return;
  // A patch is still when all batches that hold its elements are: their rotations and traces are then those at x.
  state.still.assign(patches_.size(), true);
  for (const BatchRange range : state.held.moving) {
    for (std::size_t b = range.begin; b < range.end; ++b) {
      for (const int p : patch_of_[b]) state.still[p] = false;
    }
  }
  addForces(x, state.held.still, true, state, state.held.forces);
  state.pressed.clear();
  for (std::size_t b = 0; b < patch_of_.size(); ++b) {
    if (std::all_of(patch_of_[b].begin(), patch_of_[b].end(), [&](int p) { return state.still[p]; })) continue;
    if (!state.pressed.empty() && state.pressed.back().end == b) {
      ++state.pressed.back().end;
    } else {
      state.pressed.push_back({b, b + 1});
    }
  }
}

double MeanDilatation::energy(const NodalVectors& x) const {
  PatchState state;
  if (corotational_) {
    state.rotations.resize(tets().batches.size());
    for (std::size_t e = 0; e < tets().elements.size(); ++e) {
      const Quaternion q = nearestRotation(deformationGradient(tets().elements[e], x), Quaternion::Identity());
      const double parts[4] = {q.w(), q.x(), q.y(), q.z()};
      for (std::size_t i = 0; i < 4; ++i) state.rotations[e / kLanes][i][e % kLanes] = parts[i];
    }
  }
  double energy = TetElasticity::energy(x);
  std::vector<Vector3> gradients(most_nodes_);
  for (const Patch& patch : patches_) {
    std::fill(gradients.begin(), gradients.end(), Vector3::Zero());
    addGradients(patch, state, gradients.data());
    const double mean = dilatation(patch, gradients.data(), x);
    energy += 0.5 * patch.bulk * patch.volume * mean * mean;
  }
  return energy;
}

}  // namespace tissue_contact
