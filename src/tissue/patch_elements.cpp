#include "tissue/patch_elements.h"

#include <algorithm>

namespace tissue_contact {

namespace {

/// Means over a patch's volume: of its elements' materials; into `gradients`, of their shape functions, per node.
LameParameters meanOf(const DilatationPatches::Patch& patch, const TetElements& tets, const ElementMaterials& materials,
                      const TetElements::Lame& lameOf, std::vector<Vector3>& gradients) {
  LameParameters mean = {0.0, 0.0};
  for (const DilatationPatches::Member& member : patch.members) {
    const double part = tets.volume(member.element) / patch.volume;
    const Eigen::Matrix<double, 3, 4> c = tets.shapeGradients(member.element);
    for (int i = 0; i < 4; ++i) gradients[member.local[i]] += part * c.col(i);
    const LameParameters lame = lameOf(materials.of(member.element));
    mean.lambda += part * lame.lambda;
    mean.mu += part * lame.mu;
  }
  return mean;
}

}  // namespace

PatchElements::PatchElements(const DilatationPatches& averaged, const TetElements& tets,
                             const ElementMaterials& element_materials, const TetElements::Lame& lameOf) {
  const std::vector<DilatationPatches::Patch>& patches = averaged.patches;
  keepSlots(patches);
  batches.resize((patches.size() + kLanes - 1) / kLanes);
  materials.resize(batches.size());
  ShapeTable<3> table;
  std::vector<std::size_t> places;  // per node: that of its gradients
  std::vector<ShapeBatch<3>> of_batch;
  for (std::size_t slot = 0; slot < batches.size() * kLanes; ++slot) {
    const std::size_t p = std::min(slot, patches.size() - 1);
    const std::size_t lane = slot % kLanes;
    PatchBatch& batch = batches[slot / kLanes];
    if (lane == 0) {
      batch.first = nodes.size();
      batch.count = *std::max_element(counts_.begin() + static_cast<std::ptrdiff_t>(p),
                                      counts_.begin() + static_cast<std::ptrdiff_t>(std::min(p + kLanes, size())));
      nodes.resize(nodes.size() + batch.count);
      of_batch.resize(batch.count);
    }
    const DilatationPatches::Patch& patch = patches[p];
    std::vector<Vector3> gradients(batch.count, Vector3::Zero());
    const LameParameters mean = meanOf(patch, tets, element_materials, lameOf, gradients);
    for (std::size_t i = 0; i < batch.count; ++i) {
      nodes[batch.first + i].nodes[lane] = patch.nodes[i < patch.nodes.size() ? i : 0];
      for (int r = 0; r < 3; ++r) of_batch[i][r][lane] = gradients[i][r];
    }
    if (lane == kLanes - 1) {
      for (const ShapeBatch<3>& gradient : of_batch) places.push_back(table.add(gradient));
    }
    batch.volume[lane] = slot < patches.size() ? patch.volume : 0.0;
    materials[slot / kLanes].lambda[lane] = mean.lambda;
    materials[slot / kLanes].mu[lane] = mean.mu;
  }
  nodes.shrink_to_fit();
  gradients_ = table.shapes();
  for (std::size_t i = 0; i < nodes.size(); ++i) nodes[i].gradient = &gradients_[places[i]];
}

void PatchElements::keepSlots(const std::vector<DilatationPatches::Patch>& patches) {
  slots_of_.push_back(0);
  for (const DilatationPatches::Patch& patch : patches) {
    counts_.push_back(patch.nodes.size());
    most_nodes = std::max(most_nodes, patch.nodes.size());
    damping_s_.push_back(patch.damping_s);
    slots_.insert(slots_.end(), patch.slots.begin(), patch.slots.end());
    slots_of_.push_back(slots_.size());
  }
  slots_.shrink_to_fit();
}

void PatchElements::split(const std::vector<bool>& still, std::vector<BatchRange>& moving,
                          std::vector<BatchRange>& resting) const {
  splitBatches(
      batches.size(),
      [&](std::size_t b) {
        const auto first = nodes.begin() + static_cast<std::ptrdiff_t>(batches[b].first);
        return std::all_of(first, first + static_cast<std::ptrdiff_t>(batches[b].count), [&](const PatchNode& four) {
          return std::all_of(four.nodes.begin(), four.nodes.end(), [&](int node) { return still[node]; });
        });
      },
      moving, resting);
}

Vector3 PatchElements::gradient(std::size_t patch, std::size_t node) const {
  const PatchNode& four = nodes[batches[patch / kLanes].first + node];
  const std::size_t lane = patch % kLanes;
  return {(*four.gradient)[0][lane], (*four.gradient)[1][lane], (*four.gradient)[2][lane]};
}

Matrix3 PatchElements::deformationGradient(std::size_t patch, const NodalVectors& x) const {
  const PatchNode* const first = &nodes[batches[patch / kLanes].first];
  const auto at = [&](std::size_t i) { return Vector3(x.col(first[i].nodes[patch % kLanes])); };
  // Gradients sum to zero, so positions may be taken from the first node: no loss of digits far from the origin.
  Matrix3 F = Matrix3::Zero();
  for (std::size_t i = 1; i < counts_[patch]; ++i) F += (at(i) - at(0)) * gradient(patch, i).transpose();
  return F;
}

/// @param blockOf nodes i <= j: the block of K to be added.
template <typename BlockOf>
void PatchElements::addBlocks(std::size_t patch, const BlockOf& blockOf, Elasticity::State& state) const {
  const int* next = slots(patch);
  for (std::size_t i = 0; i < counts_[patch]; ++i) {
    for (std::size_t j = i; j < counts_[patch]; ++j) {
      const int slot = *next++;
      if (slot < 0) continue;
      addBlock(i == j, slot, blockOf(i, j), damping_s_[patch], state.stiffness, state.damping);
    }
  }
}

void PatchElements::addStiffness(std::size_t patch, const Matrix3& R, Elasticity::State& state) const {
  const LameParameters lame = material(patch);
  const double lambda = volume(patch) * lame.lambda;
  const double mu = volume(patch) * lame.mu;
  addBlocks(
      patch,
      [&](std::size_t i, std::size_t j) {
        const Vector3 a = R * gradient(patch, i);
        const Vector3 b = R * gradient(patch, j);
        Matrix3 block = (lambda * a) * b.transpose() + (mu * b) * a.transpose();
        block.diagonal().array() += mu * a.dot(b);
        return block;
      },
      state);
}

void PatchElements::turnStiffness(std::size_t patch, const Matrix3& old, const Matrix3& R,
                                  std::vector<PaddedGradient>& scratch, Elasticity::State& state) const {
  const LameParameters lame = material(patch);
  const double lambda = volume(patch) * lame.lambda;
  const double mu = volume(patch) * lame.mu;
  PaddedGradient* const a = scratch.data();
  PaddedGradient* const b = a + most_nodes;
  for (std::size_t i = 0; i < counts_[patch]; ++i) {
    a[i] = turnedGradient(R, gradient(patch, i));
    b[i] = turnedGradient(old, gradient(patch, i));
  }
  addBlocks(
      patch, [&](std::size_t i, std::size_t j) { return turnedBlock(lambda, mu, a[i], a[j], b[i], b[j]); }, state);
}

}  // namespace tissue_contact
