/// @file
/// Room `core`: sparse symmetric matrix of 3x3 blocks over the nodes of a mesh. Of each pair of blocks that mirror each
/// other one is stored, four rows side by side, so that products go through it with four rows at a time.
///
/// Sliced storage: Monakov, Lokhmotov & Avetisyan, "Automatically Tuning Sparse Matrix-Vector Multiplication for GPU
/// Architectures", HiPEAC 2010. Which rows lie side by side: those that a Gauss-Seidel sweep in the order of the nodes
/// may visit together (level scheduling: Saad, "Iterative Methods for Sparse Linear Systems", 2nd ed., section 11.6),
/// so that such a sweep gives what it gives row by row.
#pragma once

#include <array>
#include <cstddef>
#include <memory>
#include <vector>

#include "tissue_contact/core/state_archive.h"
#include "tissue_contact/core/types.h"

namespace tissue_contact {

/// Where blocks lie. Block (i, j) and its mirror image (j, i) share a place; the block stored is the one with i < j.
struct BlockPattern {
  static constexpr int kRows = 4;  ///< of a slice, one per lane

  /// A block below the diagonal, as seen from its row.
  struct Lower {
    int column;
    int place;
  };

  int nodes = 0;
  /// kRows nodes per slice; one that would have fewer repeats its first row, with blocks of zero. No row has a block
  /// with another one of its slice, and blocks (i, j) with i < j have i in an earlier slice than j.
  std::vector<int> rows;
  std::vector<int> first;  ///< slices + 1 offsets of entries: one block for each row of the slice
  /// kRows per entry. Ascending in each lane, beyond the row; the row itself where there is no block.
  std::vector<int> columns;
  std::vector<int> lane_of;      ///< per node: kRows * slice + lane
  std::vector<int> lower_first;  ///< nodes + 1 offsets into `lower`
  std::vector<Lower> lower;      ///< columns ascending within a row

  /// A block for every pair of free nodes that share an element (a range of node indices). Fixed nodes get none off the
  /// diagonal.
  template <typename Elements>
  static std::shared_ptr<const BlockPattern> forElements(const Elements& elements, const std::vector<bool>& fixed) {
    std::vector<int> first = {0};  // of the free nodes of each element
    std::vector<int> nodes;
    for (const auto& element : elements) {
      for (const int node : element) {
        if (!fixed[node]) nodes.push_back(node);
      }
      first.push_back(static_cast<int>(nodes.size()));
    }
    return fromElements(first, nodes, fixed.size());
  }

  int slices() const { return static_cast<int>(first.size()) - 1; }               ///< of four rows each
  std::size_t entries() const { return static_cast<std::size_t>(first.back()); }  ///< of four blocks each

  /// Place of block (row, column): 2 (4 entry + lane), 1 more for a mirror image; -1 when it is not stored. Not for the diagonal.
  int find(int row, int column) const;

  /// Calls use(column, place) for the blocks of a row off the diagonal, columns ascending.
  template <typename Use>
  void forRow(int row, const Use& use) const {
    for (int k = lower_first[row]; k < lower_first[row + 1]; ++k) use(lower[k].column, lower[k].place);
    const int slice = lane_of[row] / kRows;
    const int lane = lane_of[row] % kRows;
    for (int k = first[slice]; k < first[slice + 1] && columns[kRows * k + lane] != row; ++k) {
      use(columns[kRows * k + lane], placeOf(k, lane, false));
    }
  }

  static int placeOf(int entry, int lane, bool mirrored) { return 2 * (kRows * entry + lane) + (mirrored ? 1 : 0); }

 private:
  /// @param first offsets of the elements in `nodes`, and the end.
  static std::shared_ptr<const BlockPattern> fromElements(const std::vector<int>& first, const std::vector<int>& nodes,
                                                          std::size_t node_count);
};

/// Blocks of one entry. Element (r, c) of the block in lane l: at[r + 3 c][l].
struct alignas(32) BlockLanes {
  std::array<std::array<double, BlockPattern::kRows>, 9> at;
};

/// Rows and columns are nodes. Empty, or made for a pattern.
struct BlockMatrix {
  std::shared_ptr<const BlockPattern> pattern;
  std::vector<Matrix3> diagonal;   ///< one per node
  std::vector<BlockLanes> values;  ///< one per entry

  BlockMatrix() = default;
  /// Zero.
  explicit BlockMatrix(std::shared_ptr<const BlockPattern> of);

  template <typename Elements>
  static BlockMatrix forElements(const Elements& elements, const std::vector<bool>& fixed) {
    return BlockMatrix(BlockPattern::forElements(elements, fixed));
  }
  static BlockMatrix forTetrahedra(const std::vector<Tetrahedron>& tetrahedra, const std::vector<bool>& fixed) {
    return forElements(tetrahedra, fixed);
  }

  int rows() const { return static_cast<int>(diagonal.size()); }

  /// Block at a place that the pattern has found, as seen from the row that was asked for.
  Matrix3 block(int place) const {
    const BlockLanes& entry = values[static_cast<std::size_t>(place / 2) / BlockPattern::kRows];
    const std::size_t lane = static_cast<std::size_t>(place / 2) % BlockPattern::kRows;
    Matrix3 result;
    for (std::size_t m = 0; m < 9; ++m) result.data()[m] = entry.at[m][lane];
    if (place % 2 != 0) result.transposeInPlace();
    return result;
  }

  /// Adds to the block at a place, and thereby to its mirror image.
  void add(int place, const Matrix3& block) {
    BlockLanes& entry = values[static_cast<std::size_t>(place / 2) / BlockPattern::kRows];
    const std::size_t lane = static_cast<std::size_t>(place / 2) % BlockPattern::kRows;
    const std::size_t down = place % 2 == 0 ? 1 : 3;
    for (std::size_t c = 0; c < 3; ++c) {
      for (std::size_t r = 0; r < 3; ++r) entry.at[down * r + (4 - down) * c][lane] += block.data()[r + 3 * c];
    }
  }

  void setZero();

  void carry(StateArchive& archive);  ///< the blocks; the pattern is the reader's

  /// Takes over the blocks of a matrix of the same pattern. No allocation.
  void copyBlocks(const BlockMatrix& from);

  /// Becomes a_scale a + b_scale b, which have the same pattern as this. No allocation.
  void setSum(double a_scale, const BlockMatrix& a, double b_scale, const BlockMatrix& b);

  /// Sum over off-diagonal blocks of row `i`: sum_j A_ij v_j.
  Vector3 offDiagonalProduct(int i, const NodalVectors& v) const;
};

}  // namespace tissue_contact
