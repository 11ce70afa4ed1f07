/// @file
/// Room `tissue`, private: where the blocks of an element lie in the stiffness matrix, found once.
#pragma once

#include <array>
#include <vector>

#include "tissue_contact/core/block_matrix.h"

namespace tissue_contact {

/// Slot (i, j) of an element's nodes i and j: an index into BlockMatrix::values, the node if i = j; -1: not stored.
template <std::size_t N>
using BlockSlots = std::array<std::array<int, N>, N>;

/// Of the block of nodes a and b.
inline int slotOf(const BlockMatrix& pattern, const std::vector<bool>& fixed, int a, int b) {
  return a == b ? (fixed[a] ? -1 : a) : pattern.find(a, b);
}

/// Adds a block to K and, if there is a D, `damping_s` times the block to D.
inline void addBlock(bool on_diagonal, int slot, const Matrix3& block, double damping_s, BlockMatrix& K,
                     BlockMatrix& D) {
  (on_diagonal ? K.diagonal : K.values)[slot] += block;
  if (D.rows() > 0) (on_diagonal ? D.diagonal : D.values)[slot] += damping_s * block;
}

template <std::size_t N>
BlockSlots<N> findSlots(const BlockMatrix& pattern, const std::array<int, N>& nodes, const std::vector<bool>& fixed) {
  BlockSlots<N> slots;
  for (std::size_t i = 0; i < N; ++i) {
    for (std::size_t j = 0; j < N; ++j) slots[i][j] = slotOf(pattern, fixed, nodes[i], nodes[j]);
  }
  return slots;
}

/// Adds block (i, j), i <= j, and its mirror image.
template <std::size_t N>
inline void addBlock(const BlockSlots<N>& slots, std::size_t i, std::size_t j, const Matrix3& block, BlockMatrix& K) {
  if (i == j) {
    K.diagonal[slots[i][i]] += block;
  } else {
    K.values[slots[i][j]] += block;
    K.values[slots[j][i]] += block.transpose();
  }
}

/// The same, and, if there is a D, `damping_s` times the block to D.
template <std::size_t N>
inline void addBlock(const BlockSlots<N>& slots, std::size_t i, std::size_t j, const Matrix3& block, double damping_s,
                     BlockMatrix& K, BlockMatrix& D) {
  addBlock(slots, i, j, block, K);
  if (D.rows() > 0) addBlock(slots, i, j, damping_s * block, D);
}

}  // namespace tissue_contact
