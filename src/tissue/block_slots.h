/// @file
/// Room `tissue`, private: where the blocks of an element lie in the stiffness matrix, found once.
#pragma once

#include <array>
#include <cassert>
#include <cstddef>
#include <vector>

#include "tissue_contact/core/block_matrix.h"

namespace tissue_contact {

/// Where an element's blocks lie. Slot (i, j), i <= j, of its nodes i and j: BlockPattern::find(), the node if i = j; -1: not
/// stored.
template <std::size_t N>
class BlockSlots {
 public:
  int& operator()(std::size_t i, std::size_t j) { return at_[placeOf(i, j)]; }
  int operator()(std::size_t i, std::size_t j) const { return at_[placeOf(i, j)]; }
  const int* rowByRow() const { return at_.data(); }

 private:
  static std::size_t placeOf(std::size_t i, std::size_t j) {
    assert(i <= j && j < N);
    return i * (2 * N - i - 1) / 2 + j;
  }

  std::array<int, N*(N + 1) / 2> at_;  ///< row by row
};

/// Of the block of nodes a and b.
inline int slotOf(const BlockPattern& pattern, const std::vector<bool>& fixed, int a, int b) {
  return a == b ? (fixed[a] ? -1 : a) : pattern.find(a, b);
}

template <std::size_t N>
BlockSlots<N> findSlots(const BlockPattern& pattern, const std::array<int, N>& nodes, const std::vector<bool>& fixed) {
  BlockSlots<N> slots;
  for (std::size_t i = 0; i < N; ++i) {
    for (std::size_t j = i; j < N; ++j) slots(i, j) = slotOf(pattern, fixed, nodes[i], nodes[j]);
  }
  return slots;
}

/// Adds a block, and off the diagonal thereby its mirror image.
inline void addBlock(bool on_diagonal, int slot, const Matrix3& block, BlockMatrix& K) {
  if (on_diagonal) {
    K.diagonal[slot] += block;
  } else {
    K.add(slot, block);
  }
}

/// The same, and, if there is a D, `damping_s` times the block to D.
inline void addBlock(bool on_diagonal, int slot, const Matrix3& block, double damping_s, BlockMatrix& K,
                     BlockMatrix& D) {
  addBlock(on_diagonal, slot, block, K);
  if (D.rows() > 0) addBlock(on_diagonal, slot, damping_s * block, D);
}

}  // namespace tissue_contact
