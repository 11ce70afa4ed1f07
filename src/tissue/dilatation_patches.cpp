#include "tissue/dilatation_patches.h"

#include <algorithm>
#include <stdexcept>
#include <string>
#include <utility>

namespace tissue_contact {
namespace {

// What few patches have more of: element_patches.h, Bisection.
constexpr std::size_t kManyNodes = 12;
constexpr std::size_t kManyMembers = 6;

}  // namespace

double bulkModulus(const MaterialDescription& material) {
  const LameParameters lame = lameParameters(material);
  return lame.lambda + 2.0 / 3.0 * lame.mu;
}

std::vector<std::vector<int>> DilatationPatches::nodesOf(const std::vector<Tetrahedron>& tetrahedra,
                                                         const std::vector<int>& patch_of) {
  if (patch_of.size() != tetrahedra.size()) {
    throw std::invalid_argument("patches: " + std::to_string(patch_of.size()) + " patch numbers given for " +
                                std::to_string(tetrahedra.size()) + " tetrahedra");
  }
  std::vector<std::vector<int>> nodes;
  for (std::size_t e = 0; e < tetrahedra.size(); ++e) {
    if (patch_of[e] < 0) throw std::invalid_argument("patches: patch number " + std::to_string(patch_of[e]));
    nodes.resize(std::max(nodes.size(), static_cast<std::size_t>(patch_of[e]) + 1));
    std::vector<int>& patch = nodes[patch_of[e]];
    patch.reserve(kManyNodes);
    for (const int node : tetrahedra[e]) {
      if (std::find(patch.begin(), patch.end(), node) == patch.end()) patch.push_back(node);
    }
  }
  for (std::vector<int>& patch : nodes) std::sort(patch.begin(), patch.end());
  return nodes;
}

DilatationPatches::DilatationPatches(const std::vector<Tetrahedron>& tetrahedra, const std::vector<bool>& fixed,
                                     const ElementMaterials& materials, const std::vector<int>& patch_of,
                                     std::vector<std::vector<int>> nodes, const TetElements& tets) {
  patches.resize(nodes.size());
  for (std::size_t e = 0; e < tetrahedra.size(); ++e) {
    Patch& patch = patches[patch_of[e]];
    const std::vector<int>& of_patch = nodes[patch_of[e]];
    patch.members.reserve(kManyMembers);
    Member& member = patch.members.emplace_back(Member{e, {}});
    for (int i = 0; i < 4; ++i) {
      const auto at = std::lower_bound(of_patch.begin(), of_patch.end(), tetrahedra[e][i]);
      member.local[i] = static_cast<int>(at - of_patch.begin());
    }
    const double volume = tets.volume(e);
    patch.volume += volume;
    patch.bulk += volume * bulkModulus(materials.of(e));
    patch.damping_s += volume * materials.dampingOf(e);
  }
  for (std::size_t e = 0; e < kLanes * tets.batches.size(); ++e) {
    if (e % kLanes == 0) of_batch.emplace_back();
    of_batch.back()[e % kLanes] = patch_of[std::min(e, patch_of.size() - 1)];
  }
  std::size_t first = 0;
  for (std::size_t p = 0; p < patches.size(); ++p) {
    Patch& patch = patches[p];
    if (patch.members.empty()) throw std::invalid_argument("patches: patch " + std::to_string(p) + " is empty");
    patch.bulk /= patch.volume;
    patch.damping_s /= patch.volume;
    patch.nodes = std::move(nodes[p]);
    patch.first = first;
    first += patch.nodes.size();
    const std::size_t count = patch.nodes.size();
    patch.slots.reserve(count * (count + 1) / 2);
    for (std::size_t i = 0; i < count; ++i) {
      for (std::size_t j = i; j < count; ++j) {
        patch.slots.push_back(slotOf(*tets.pattern, fixed, patch.nodes[i], patch.nodes[j]));
      }
    }
  }
}

void DilatationPatches::split(const TetElements::Held& batches, Held& held) const {
  held.still.clear();
  held.pressed = {{0, of_batch.size()}};
  if (batches.still.empty()) return;
  held.still.assign(patches.size(), true);
  for (const BatchRange range : batches.moving) {
    for (std::size_t b = range.begin; b < range.end; ++b) {
      for (const int p : of_batch[b]) held.still[p] = false;
    }
  }
  held.pressed.clear();
  held.pressed.reserve((of_batch.size() + 1) / 2);  // the most there can be
  for (std::size_t b = 0; b < of_batch.size(); ++b) {
    if (std::all_of(of_batch[b].begin(), of_batch[b].end(), [&](int p) { return held.still[p]; })) continue;
    if (!held.pressed.empty() && held.pressed.back().end == b) {
      ++held.pressed.back().end;
    } else {
      held.pressed.push_back({b, b + 1});
    }
  }
}

void DilatationPatches::Held::carry(StateArchive& archive, std::size_t patches, std::size_t batches) {
  bool any = !still.empty();
  archive.carry(any);
  still.resize(any ? patches : 0);
  archive.carry(still);
  carryRanges(archive, batches, pressed);
}

void DilatationPatches::meanPressures(const std::vector<ElementBatch>& batches, const std::vector<BatchRange>& ranges,
                                      const std::vector<ElementValues>& values, double at_rest, bool still,
                                      const Held& held, std::vector<double>& pressures) const {
  std::fill(pressures.begin(), pressures.end(), 0.0);
  for (const BatchRange range : ranges) {
    for (std::size_t b = range.begin; b < range.end; ++b) {
      for (std::size_t lane = 0; lane < kLanes; ++lane) {
        pressures[of_batch[b][lane]] += batches[b].volume[lane] * (values[b][lane] - at_rest);
      }
    }
  }
  for (std::size_t p = 0; p < patches.size(); ++p) {
    pressures[p] = held.isStill(p) == still ? patches[p].bulk / patches[p].volume * pressures[p] : 0.0;
  }
}

void DilatationPatches::addStiffness(const Patch& patch, const Vector3* b, const Vector3* old,
                                     Elasticity::State& state) {
  const double scale = patch.bulk / patch.volume;
  const std::size_t count = patch.nodes.size();
  const int* next = patch.slots.data();
  for (std::size_t i = 0; i < count; ++i) {
    for (std::size_t j = i; j < count; ++j) {
      const int slot = *next++;
      if (slot < 0) continue;
      Matrix3 block = Matrix3::Zero();
      if (b != nullptr) block = (scale * b[i]) * b[j].transpose();
      if (old != nullptr) block -= (scale * old[i]) * old[j].transpose();
      addBlock(i == j, slot, block, patch.damping_s, state.stiffness, state.damping);
    }
  }
}

}  // namespace tissue_contact
