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
  std::size_t first = 0;   ///< of its nodes in PatchState::tangent_gradients
};

struct MeanDilatation::PatchState : RotationState {
  std::vector<Vector3> gradients;          ///< b of every patch's nodes, patch after patch, m^2
  std::vector<Vector3> tangent_gradients;  ///< those `stiffness` was computed with
  std::vector<bool> still;                 ///< per patch: its forces are among the held ones; empty: none is
};

namespace {

/// What is left of a material without its resistance to changes of volume.
LameParameters deviatoric(const MaterialDescription& material) {
  const double mu = lameParameters(material).mu;
  return {-2.0 / 3.0 * mu, mu};
}

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
                    std::make_unique<TetElements>(rest, tetrahedra, fixed, materials, deviatoric,
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
  for (const Patch& patch : patches_) {
    addGradients(patch, *state, &state->gradients[patch.first]);
    addStiffness(patch, &state->gradients[patch.first], 1.0, *state);
  }
  state->tangent_gradients = state->gradients;
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

void MeanDilatation::addStiffness(const Patch& patch, const Vector3* gradients, double sign, State& state) const {
  const double scale = sign * patch.bulk / patch.volume;
  const std::size_t count = patch.nodes.size();
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t j = 0; j < count; ++j) {
      const int slot = patch.slots[i * count + j];
      if (slot < 0) continue;
      const Matrix3 block = (scale * gradients[i]) * gradients[j].transpose();
      addBlock(i == j, slot, block, patch.damping_s, state.stiffness, state.damping);
    }
  }
}

/// Whether TetElasticity has refreshed the tangent of an element of the patch.
bool MeanDilatation::turned(const Patch& patch, const RotationState& state) const {
  return std::any_of(patch.members.begin(), patch.members.end(), [&](const Patch::Member& member) {
    return (state.turned[member.element / kLanes] >> (member.element % kLanes) & 1) != 0;
  });
}

/// Brings the gradients of a patch, and its share of the stiffness, in line with the rotations of its elements.
void MeanDilatation::follow(const Patch& patch, PatchState& state) const {
  Vector3* const gradients = &state.gradients[patch.first];
  std::fill(gradients, gradients + patch.nodes.size(), Vector3::Zero());
  addGradients(patch, state, gradients);
  if (!turned(patch, state)) return;
  Vector3* const tangent = &state.tangent_gradients[patch.first];
  addStiffness(patch, tangent, -1.0, state);
  addStiffness(patch, gradients, 1.0, state);
  std::copy(gradients, gradients + patch.nodes.size(), tangent);
}

void MeanDilatation::addForces(const Patch& patch, const NodalVectors& x, const PatchState& state,
                               NodalVectors& forces) {
  const Vector3* const gradients = &state.gradients[patch.first];
  const double pressure = patch.bulk * dilatation(patch, gradients, x);
  for (std::size_t i = 0; i < patch.nodes.size(); ++i) forces.col(patch.nodes[i]) -= pressure * gradients[i];
}

void MeanDilatation::update(const NodalVectors& x, State& any_state, NodalVectors& forces) const {
  TetElasticity::update(x, any_state, forces);
  auto& state = static_cast<PatchState&>(any_state);  // made by makeState()
  for (std::size_t p = 0; p < patches_.size(); ++p) {
    if (!state.still.empty() && state.still[p]) continue;
    if (corotational_) follow(patches_[p], state);
    addForces(patches_[p], x, state, forces);
  }
}

void MeanDilatation::holdStill(const std::vector<bool>& still, const NodalVectors& x, State& any_state) const {
  TetElasticity::holdStill(still, x, any_state);
  auto& state = static_cast<PatchState&>(any_state);
  state.still.assign(state.held.forces.cols() > 0 ? patches_.size() : 0, false);
  for (std::size_t p = 0; p < state.still.size(); ++p) {
    const std::vector<int>& nodes = patches_[p].nodes;
    state.still[p] = std::all_of(nodes.begin(), nodes.end(), [&](int node) { return static_cast<bool>(still[node]); });
    if (corotational_) follow(patches_[p], state);  // also those that move: some of their elements may be still
    if (state.still[p]) addForces(patches_[p], x, state, state.held.forces);
  }
  for (const BatchRange range : state.held.still) {
    std::fill_n(state.turned.data() + range.begin, range.end - range.begin, 0);
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
