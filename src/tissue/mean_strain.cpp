#include "tissue/mean_strain.h"

#include <utility>

#include "tissue/dilatation_patches.h"
#include "tissue/rotation_state.h"
#include "tissue/tet_elements.h"

namespace tissue_contact {
namespace {

/// Of elements without resistance to changes of volume, and with what patches leave of that to changes of shape.
TetElements::Lame ownParameters(double shape_share) {
  return [own = 1.0 - shape_share](const MaterialDescription& material) -> LameParameters {
    const LameParameters all = deviatoricParameters(material);
    return {own * all.lambda, own * all.mu};
  };
}

/// Of patches: lambda = kappa - 2/3 mu.
TetElements::Lame patchParameters(double shape_share) {
  return [shape_share](const MaterialDescription& material) -> LameParameters {
    const double mu = shape_share * lameParameters(material).mu;
    return {bulkModulus(material) - 2.0 / 3.0 * mu, mu};
  };
}

}  // namespace

/// Rotations of patches are kept as those of elements are.
struct MeanStrain::PatchState : RotationState {
  std::vector<RotationBatch> patch_rotations;
  std::vector<RotationBatch> tangent_patch_rotations;
  std::vector<unsigned char> turned_patches;  ///< scratch
  std::vector<PaddedGradient> gradients;      ///< scratch
  std::vector<BatchRange> moving_patches;
  std::vector<BatchRange> still_patches;

  void carry(StateArchive& archive) override {
    RotationState::carry(archive);
    archive.carry(patch_rotations);
    archive.carry(tangent_patch_rotations);
    carryRanges(archive, patch_rotations.size(), moving_patches);
    carryRanges(archive, patch_rotations.size(), still_patches);
  }
};

MeanStrain::MeanStrain(const NodalVectors& rest, const std::vector<Tetrahedron>& tetrahedra,
                       const std::vector<bool>& fixed, const ElementMaterials& materials,
                       const std::vector<int>& patch_of, double shape_share)
    : MeanStrain(rest, tetrahedra, fixed, materials, patch_of, DilatationPatches::nodesOf(tetrahedra, patch_of),
                 shape_share) {}

MeanStrain::MeanStrain(const NodalVectors& rest, const std::vector<Tetrahedron>& tetrahedra,
                       const std::vector<bool>& fixed, const ElementMaterials& materials,
                       const std::vector<int>& patch_of, std::vector<std::vector<int>> patch_nodes, double shape_share)
    : TetElasticity(materials.materials.at(0).model == ElasticModel::kCorotational,
                    std::make_unique<TetElements>(rest, tetrahedra, fixed, materials, ownParameters(shape_share),
                                                  BlockPattern::forElements(patch_nodes, fixed))),
      corotational_(materials.materials.at(0).model == ElasticModel::kCorotational),
      patches_(DilatationPatches(tetrahedra, fixed, materials, patch_of, std::move(patch_nodes), tets()), tets(),
               materials, patchParameters(shape_share)) {}

MeanStrain::~MeanStrain() = default;

std::unique_ptr<Elasticity::State> MeanStrain::makeState() const { return makeState(nullptr); }

std::unique_ptr<Elasticity::State> MeanStrain::makeStateAt(const NodalVectors& x) const { return makeState(&x); }

std::unique_ptr<Elasticity::State> MeanStrain::makeState(const NodalVectors* x) const {
  auto state = std::make_unique<PatchState>();
  prepare(x, *state);
  RotationBatch identity{};
  identity[0].fill(1.0);
  state->patch_rotations.assign(patches_.batches.size(), identity);
  state->tangent_patch_rotations = state->patch_rotations;
  state->turned_patches.assign(patches_.batches.size(), 0);
  state->gradients.resize(2 * patches_.most_nodes);
  state->moving_patches = {{0, patches_.batches.size()}};
  if (x != nullptr && corotational_) {  // rotations are those of update(), from none
    state->nodes.begin(*x, {});
    addPatchForces(patches_, {0, patches_.batches.size()}, true, kTangentAngle, state->nodes.x.data(),
                   state->tangent_patch_rotations, state->patch_rotations, state->turned_patches,
                   state->nodes.forces.data());
    state->tangent_patch_rotations = state->patch_rotations;
  }
  for (std::size_t p = 0; p < patches_.size(); ++p) {
    const Quaternion q = rotationInLane(state->tangent_patch_rotations[p / kLanes], p % kLanes);
    patches_.addStiffness(p, q.toRotationMatrix(), *state);
  }
  return state;
}

/// Adds the forces of these batches of patches to state.nodes, and brings their share of the stiffness up to date.
void MeanStrain::addForces(const std::vector<BatchRange>& ranges, PatchState& state) const {
  for (const BatchRange range : ranges) {
    addPatchForces(patches_, range, corotational_, kTangentAngle, state.nodes.x.data(), state.tangent_patch_rotations,
                   state.patch_rotations, state.turned_patches, state.nodes.forces.data());
    for (std::size_t b = range.begin; corotational_ && b < range.end; ++b) {
      for (std::size_t lane = 0; lane < kLanes && state.turned_patches[b] >> lane != 0; ++lane) {
        const std::size_t p = b * kLanes + lane;
        if ((state.turned_patches[b] >> lane & 1) == 0 || p >= patches_.size()) continue;
        RotationBatch& tangents = state.tangent_patch_rotations[b];
        const Matrix3 old = rotationInLane(tangents, lane).toRotationMatrix();
        for (std::size_t i = 0; i < 4; ++i) tangents[i][lane] = state.patch_rotations[b][i][lane];
        patches_.turnStiffness(p, old, rotationInLane(tangents, lane).toRotationMatrix(), state.gradients, state);
      }
    }
  }
}

void MeanStrain::update(const NodalVectors& x, State& any_state, NodalVectors& forces) const {
  auto& state = static_cast<PatchState&>(any_state);  // made by makeState()
  updateElements(x, state);
  addForces(state.moving_patches, state);
  unpad(state.nodes.forces, forces);
}

void MeanStrain::holdStill(const std::vector<bool>& still, const NodalVectors& x, State& any_state) const {
  TetElasticity::holdStill(still, x, any_state);
  auto& state = static_cast<PatchState&>(any_state);
  patches_.split(still, state.moving_patches, state.still_patches);
  addForces(state.still_patches, state);
  unpad(state.nodes.forces, state.held.forces);
}

double MeanStrain::energy(const NodalVectors& x) const {
  double energy = TetElasticity::energy(x);
  for (std::size_t p = 0; p < patches_.size(); ++p) {
    const Matrix3 F = patches_.deformationGradient(p, x);
    Matrix3 S = F;
    if (corotational_) S = nearestRotation(F, Quaternion::Identity()).toRotationMatrix().transpose() * F;
    const Matrix3 e = 0.5 * (S + S.transpose()) - Matrix3::Identity();
    const LameParameters lame = patches_.material(p);
    energy += patches_.volume(p) * (lame.mu * e.squaredNorm() + 0.5 * lame.lambda * e.trace() * e.trace());
  }
  return energy;
}

}  // namespace tissue_contact
