/// @file
/// Room `tissue`, private: patches of tetrahedra as elements of their own, with one strain each: laid out for the force kernel, and
/// where their stiffness goes.
#pragma once

#include <array>
#include <vector>

#include "tissue/dilatation_patches.h"
#include "tissue/lanes.h"
#include "tissue/tet_elements.h"
#include "tissue/turned_block.h"

namespace tissue_contact {

/// Four patches side by side; the last batch repeats its last patch in the lanes beyond.
struct PatchBatch {
  std::size_t first = 0;              ///< among PatchElements::nodes
  std::size_t count = 0;              ///< of nodes: those of the patch that has most
  std::array<double, kLanes> volume;  ///< m^3; 0 in lanes that are not used
};

/// A node of each of four patches. A patch with fewer than the batch has its first one again, with a gradient of zero.
struct PatchNode {
  const ShapeBatch<3>* gradient = nullptr;  ///< sum_e V grad N / sum_e V, 1/m; that of all nodes with the same
  std::array<int, kLanes> nodes;
};

struct PatchElements {
  /// @param averaged the same tetrahedra in patches.
  /// @param lame what of a material is the patches', as the model's parameters.
  PatchElements(const DilatationPatches& averaged, const TetElements& tets, const ElementMaterials& materials,
                const TetElements::Lame& lame);
  PatchElements(const PatchElements&) = delete;
  PatchElements& operator=(const PatchElements&) = delete;
  PatchElements(PatchElements&&) = default;
  PatchElements& operator=(PatchElements&&) = default;

  /// Sorts the batches by whether all nodes of their patches are in `still`.
  void split(const std::vector<bool>& still, std::vector<BatchRange>& moving, std::vector<BatchRange>& resting) const;

  /// F of a patch at positions x: the mean of its elements'.
  Matrix3 deformationGradient(std::size_t patch, const NodalVectors& x) const;

  /// Adds K_ij = V (lambda c_i c_j' + mu c_j c_i' + mu (c_i . c_j) I), c_i = R times the gradient of node i.
  void addStiffness(std::size_t patch, const Matrix3& R, Elasticity::State& state) const;

  /// Puts that of R in the place of that of `old`.
  /// @param scratch of 2 most_nodes.
  void turnStiffness(std::size_t patch, const Matrix3& old, const Matrix3& R, std::vector<PaddedGradient>& scratch,
                     Elasticity::State& state) const;

  Vector3 gradient(std::size_t patch, std::size_t node) const;  ///< 1/m

  std::size_t size() const { return slots_of_.size() - 1; }
  std::size_t nodeCount(std::size_t patch) const { return counts_[patch]; }
  const int* slots(std::size_t patch) const { return &slots_[slots_of_[patch]]; }  ///< as DilatationPatches::Patch
  double damping(std::size_t patch) const { return damping_s_[patch]; }
  double volume(std::size_t patch) const { return batches[patch / kLanes].volume[patch % kLanes]; }
  LameParameters material(std::size_t patch) const {
    const BatchMaterial& four = materials[patch / kLanes];
    return {four.lambda[patch % kLanes], four.mu[patch % kLanes]};
  }

  std::vector<PatchBatch> batches;
  std::vector<PatchNode> nodes;          ///< batch after batch
  std::vector<BatchMaterial> materials;  ///< means over the volume, Pa
  std::size_t most_nodes = 0;            ///< of a patch

 private:
  void keepSlots(const std::vector<DilatationPatches::Patch>& patches);
  template <typename BlockOf>
  void addBlocks(std::size_t patch, const BlockOf& blockOf, Elasticity::State& state) const;
  std::vector<std::size_t> counts_;    ///< nodes of each patch
  std::vector<std::size_t> slots_of_;  ///< where those of each patch begin, and the end
  std::vector<int> slots_;             ///< of node pairs i <= j, row by row, as BlockSlots
  std::vector<double> damping_s_;
  std::vector<ShapeBatch<3>> gradients_;  ///< of the nodes, which point here
};

}  // namespace tissue_contact
