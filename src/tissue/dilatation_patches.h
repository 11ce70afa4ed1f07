/// @file
/// Room `tissue`, private: patches of tetrahedra over which strain, or the change of volume alone, is averaged, with what models need of them: nodes, volume,
/// bulk modulus, places in K. Volume changes per element in; mean pressures per patch and the patches' stiffness out.
#pragma once

#include <array>
#include <vector>

#include "tissue/element_kernel.h"
#include "tissue/tet_elements.h"

namespace tissue_contact {

struct DilatationPatches {
  struct Member {
    std::size_t element;
    std::array<int, 4> local;  ///< its nodes' places in `nodes`
  };
  struct Patch {
    std::vector<Member> members;
    std::vector<int> nodes;
    std::vector<int> slots;  ///< of node pairs i <= j, row by row, as BlockSlots
    double volume = 0.0;     ///< m^3
    double bulk = 0.0;       ///< mean over the volume, Pa
    double damping_s = 0.0;  ///< likewise
    std::size_t first = 0;   ///< of its nodes among those of all patches
  };
  /// Which patches rest, as TetElements::Held for batches.
  struct Held {
    std::vector<bool> still;          ///< per patch: its forces are among the held ones; empty: none is
    std::vector<BatchRange> pressed;  ///< batches with elements of the other patches

    void carry(StateArchive& archive, std::size_t patches, std::size_t batches);
    bool isStill(std::size_t patch) const { return !still.empty() && still[patch]; }
  };

  /// Nodes of every patch, ascending.
  /// @throws std::invalid_argument for a patch_of of the wrong size or with a negative number.
  static std::vector<std::vector<int>> nodesOf(const std::vector<Tetrahedron>& tetrahedra,
                                               const std::vector<int>& patch_of);

  /// @param patch_of per tetrahedron, from 0 without gaps.
  /// @param nodes as nodesOf() has them.
  /// @param tets whose pattern holds the blocks of all patches.
  /// @throws std::invalid_argument for a wrong patch_of.
  DilatationPatches(const std::vector<Tetrahedron>& tetrahedra, const std::vector<bool>& fixed,
                    const ElementMaterials& materials, const std::vector<int>& patch_of,
                    std::vector<std::vector<int>> nodes, const TetElements& tets);

  std::size_t nodeCount() const { return patches.back().first + patches.back().nodes.size(); }

  Held nothingHeld() const { return {{}, {{0, of_batch.size()}}}; }

  /// A patch is still when all batches that hold its elements are: what is kept of these is then that of where they are.
  void split(const TetElements::Held& batches, Held& held) const;

  /// kappa times the mean of `values` - `at_rest` over each patch that is still, or that is not; 0 for the others.
  /// @param values per element, by batch; those in `ranges` are read, which hold all elements of the patches wanted.
  void meanPressures(const std::vector<ElementBatch>& batches, const std::vector<BatchRange>& ranges,
                     const std::vector<ElementValues>& values, double at_rest, bool still, const Held& held,
                     std::vector<double>& pressures) const;

  /// Adds kappa / V b b' to K, and its share to D, with b (m^2) per node of the patch, and takes out that of `old`, in one
  /// pass over the blocks. Either may be null.
  static void addStiffness(const Patch& patch, const Vector3* b, const Vector3* old, Elasticity::State& state);

  std::vector<Patch> patches;
  std::vector<std::array<int, kLanes>> of_batch;  ///< patch of each element; lanes not used repeat the last
};

double bulkModulus(const MaterialDescription& material);

}  // namespace tissue_contact
