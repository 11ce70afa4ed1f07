/// @file
/// Room `tissue`, private: tetrahedra prepared for the models: shape function gradients, volumes, materials, where
/// their stiffness goes, and the same in batches for the force kernels.
#pragma once

#include <functional>
#include <memory>
#include <vector>

#include "tissue/block_slots.h"
#include "tissue/lanes.h"
#include "tissue_contact/core/block_matrix.h"
#include "tissue_contact/core/types.h"
#include "tissue_contact/tissue/elasticity.h"
#include "tissue_contact/tissue/element_materials.h"

namespace tissue_contact {

/// One tetrahedron, as its stiffness is made of.
struct TetElement {
  double volume;        ///< m^3
  LameParameters lame;  ///< Pa; for some models their own parameters in the place of Lame's
  double damping_s;     ///< what of its stiffness goes into State::damping
  const BlockSlots<4>& slots;
};

/// Refuses what lies beyond the batches.
void carryRanges(StateArchive& archive, std::size_t batches, std::vector<BatchRange>& ranges);

/// Ranges of those of `batches` that do not rest, and of those that do.
template <typename Rests>
void splitBatches(std::size_t batches, const Rests& rests, std::vector<BatchRange>& moving,
                  std::vector<BatchRange>& still) {
  moving.clear();
  still.clear();
  moving.reserve((batches + 1) / 2);  // the most there can be: no later step allocates
  still.reserve((batches + 1) / 2);
  for (std::size_t b = 0; b < batches; ++b) {
    std::vector<BatchRange>& ranges = rests(b) ? still : moving;
    if (!ranges.empty() && ranges.back().end == b) {
      ++ranges.back().end;
    } else {
      ranges.push_back({b, b + 1});
    }
  }
}

/// Calls call(batch, lane) for each bit of `marks` that is set within the ranges. @param count of elements, or of patches: lanes beyond are not used.
template <typename Call>
void forEachMarked(const std::vector<BatchRange>& ranges, const std::vector<unsigned char>& marks, std::size_t count,
                   const Call& call) {
  for (const BatchRange range : ranges) {
    for (std::size_t batch = range.begin; batch < range.end; ++batch) {
      for (std::size_t lane = 0; lane < kLanes && marks[batch] >> lane != 0; ++lane) {
        if ((marks[batch] >> lane & 1) != 0 && batch * kLanes + lane < count) call(batch, lane);
      }
    }
  }
}

struct TetElements {
  using Lame = std::function<LameParameters(const MaterialDescription&)>;

  /// @param lame the model's elastic parameters from a material.
  /// @param couplings at least the blocks of the tetrahedra.
  /// @throws std::invalid_argument for a material out of range.
  TetElements(const NodalVectors& rest, const std::vector<Tetrahedron>& tetrahedra, const std::vector<bool>& fixed,
              const ElementMaterials& materials, const Lame& lame, std::shared_ptr<const BlockPattern> couplings);
  TetElements(const NodalVectors& rest, const std::vector<Tetrahedron>& tetrahedra, const std::vector<bool>& fixed,
              const ElementMaterials& materials, const Lame& lame)
      : TetElements(rest, tetrahedra, fixed, materials, lame, BlockPattern::forElements(tetrahedra, fixed)) {}

  TetElements(const TetElements&) = delete;
  TetElements& operator=(const TetElements&) = delete;
  TetElements(TetElements&&) = default;
  TetElements& operator=(TetElements&&) = default;

  /// Zero matrices of the right pattern.
  void prepare(Elasticity::State& state) const;

  /// What update() evaluates and what holdStill() has put aside.
  struct Held {
    std::vector<BatchRange> moving;  ///< ranges of batches, ascending
    std::vector<BatchRange> still;
    NodalVectors forces;  ///< of what is still, also of patches, N; empty: nobody has asked to hold any

    void carry(StateArchive& archive, std::size_t batches, int nodes);
  };
  Held nothingHeld() const { return {{{0, batches.size()}}, {}, {}}; }

  /// Sorts the batches by whether all nodes of their elements are in `still`; `forces` are left to the model.
  void split(const std::vector<bool>& still, Held& held) const;

  /// Gradients of the four shape functions of an element, columns, 1/m.
  Eigen::Matrix<double, 3, 4> shapeGradients(std::size_t element) const;

  Matrix3 deformationGradient(std::size_t element, const NodalVectors& x) const;

  std::size_t size() const { return slots_.size(); }
  TetElement element(std::size_t e) const;
  double volume(std::size_t e) const { return batches[e / kLanes].volume[e % kLanes]; }  ///< m^3

  std::vector<ElementBatch> batches;            ///< the elements, laid out for the force kernels
  LameParameters material;                      ///< of all elements, if batch_materials is empty
  std::vector<BatchMaterial> batch_materials;   ///< where materials differ
  std::shared_ptr<const BlockPattern> pattern;  ///< of the stiffness

 private:
  Matrix3 restInverse(std::size_t element) const;  ///< D_rest^-1, 1/m; its rows are grad N_1..N_3

  std::vector<ShapeBatch<9>> shapes_;  ///< of the batches, which point here
  std::vector<BlockSlots<4>> slots_;   ///< per element
  std::vector<double> damping_s_;      ///< per element; empty: there is no State::damping
};

}  // namespace tissue_contact
