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

template <std::size_t N>
BlockSlots<N> findSlots(const BlockMatrix& pattern, const std::array<int, N>& nodes, const std::vector<bool>& fixed) {
  BlockSlots<N> slots;
  for (std::size_t i = 0; i < N; ++i) {
    for (std::size_t j = 0; j < N; ++j) {
      slots[i][j] = i == j ? (fixed[nodes[i]] ? -1 : nodes[i]) : pattern.find(nodes[i], nodes[j]);
    }
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

}  // namespace tissue_contact
