/// @file
/// Room `core`, private: products with four rows of a BlockMatrix at a time, one row per lane, for loops that are built
/// for several vector widths. Every lane does what the plain product does in the same order, so the bits do not depend
/// on the width.
#pragma once

#include <array>
#include <cstddef>
#include <cstring>

#include "core/padded_vectors.h"
#include "tissue_contact/core/block_matrix.h"

namespace tissue_contact {

static_assert(BlockPattern::kRows == kLanes, "a row of a slice is a lane");

/// A vector per lane: x, y, z.
using LaneVectors = Lanes[3];

/// The same in memory.
struct alignas(32) SliceVectors {
  std::array<std::array<double, kLanes>, 3> at;
};

/// Symmetric blocks of four rows: xx, xy, xz, yy, yz, zz.
struct alignas(32) SymmetricBlocks {
  std::array<std::array<double, kLanes>, 6> at;
};

TISSUE_CONTACT_INLINE void load(const double* from, Lanes& to) { std::memcpy(&to, from, sizeof(Lanes)); }

TISSUE_CONTACT_INLINE void load(const SliceVectors& from, LaneVectors& to) {
  load(from.at[0].data(), to[0]);
  load(from.at[1].data(), to[1]);
  load(from.at[2].data(), to[2]);
}

// One by one: copied at once or in a loop, they would go through the stack.
TISSUE_CONTACT_INLINE void load(const SymmetricBlocks& from, Lanes (&to)[6]) {
  load(from.at[0].data(), to[0]);
  load(from.at[1].data(), to[1]);
  load(from.at[2].data(), to[2]);
  load(from.at[3].data(), to[3]);
  load(from.at[4].data(), to[4]);
  load(from.at[5].data(), to[5]);
}

TISSUE_CONTACT_INLINE void load(const BlockLanes& from, Lanes (&to)[9]) {
  load(from.at[0].data(), to[0]);
  load(from.at[1].data(), to[1]);
  load(from.at[2].data(), to[2]);
  load(from.at[3].data(), to[3]);
  load(from.at[4].data(), to[4]);
  load(from.at[5].data(), to[5]);
  load(from.at[6].data(), to[6]);
  load(from.at[7].data(), to[7]);
  load(from.at[8].data(), to[8]);
}

/// Coordinate r of four of the vectors of `v`, 3 x nodes.
TISSUE_CONTACT_INLINE void gather(const double* v, const int* nodes, std::size_t r, Lanes& to) {
  constexpr std::ptrdiff_t kStride = 3;
  const double* const w = v + r;
  to = Lanes{w[kStride * nodes[0]], w[kStride * nodes[1]], w[kStride * nodes[2]], w[kStride * nodes[3]]};
}

TISSUE_CONTACT_INLINE void gather(const double* v, const int* nodes, LaneVectors& to) {
  Lanes x, y, z;
  gather(v, nodes, 0, x);
  gather(v, nodes, 1, y);
  gather(v, nodes, 2, z);
  to[0] = x;
  to[1] = y;
  to[2] = z;
}

TISSUE_CONTACT_INLINE void scatterAdd(const Lanes* from, const int* nodes, double* v) {
  for (int lane = 0; lane < kLanes; ++lane) {
    double* const to = v + 3 * static_cast<std::ptrdiff_t>(nodes[lane]);
    for (int r = 0; r < 3; ++r) to[r] += from[r][lane];
  }
}

TISSUE_CONTACT_INLINE const int* rowsOf(const BlockPattern& pattern, int slice) {
  return &pattern.rows[kLanes * static_cast<std::size_t>(slice)];
}

/// sum += blocks * v.
TISSUE_CONTACT_INLINE void addProduct(const BlockLanes& blocks, const LaneVectors& v, LaneVectors& sum) {
  Lanes m[9];
  load(blocks, m);
  sum[0] += m[0] * v[0] + m[3] * v[1] + m[6] * v[2];
  sum[1] += m[1] * v[0] + m[4] * v[1] + m[7] * v[2];
  sum[2] += m[2] * v[0] + m[5] * v[1] + m[8] * v[2];
}

TISSUE_CONTACT_INLINE void addProduct(const SymmetricBlocks& blocks, const LaneVectors& v, LaneVectors& sum) {
  Lanes m[6];
  load(blocks, m);
  sum[0] += m[0] * v[0] + m[1] * v[1] + m[2] * v[2];
  sum[1] += m[1] * v[0] + m[3] * v[1] + m[4] * v[2];
  sum[2] += m[2] * v[0] + m[4] * v[1] + m[5] * v[2];
}

/// blocks' * v.
TISSUE_CONTACT_INLINE void mirroredProduct(const BlockLanes& blocks, const LaneVectors& v, LaneVectors& product) {
  Lanes m[9];
  load(blocks, m);
  product[0] = m[0] * v[0] + m[1] * v[1] + m[2] * v[2];
  product[1] = m[3] * v[0] + m[4] * v[1] + m[5] * v[2];
  product[2] = m[6] * v[0] + m[7] * v[1] + m[8] * v[2];
}

/// sum += blocks beyond the diagonal of a slice's rows * v.
/// @param v of all nodes, padded or not.
template <typename Vectors>
TISSUE_CONTACT_INLINE void addUpperProduct(const BlockMatrix& matrix, int slice, const Vectors* v, LaneVectors& sum) {
  const std::ptrdiff_t begin = matrix.pattern->first[slice];
  const int* columns = matrix.pattern->columns.data() + kLanes * begin;
  const BlockLanes* const end = matrix.values.data() + matrix.pattern->first[slice + 1];
  for (const BlockLanes* blocks = matrix.values.data() + begin; blocks != end; ++blocks, columns += kLanes) {
    LaneVectors column;
    gather(v, columns, column);
    addProduct(*blocks, column, sum);
  }
}

/// to_j += scale A_ij' v_i of the slice's rows i, over their columns j: what those rows add to the rows after them.
template <typename Vectors>
TISSUE_CONTACT_INLINE void scatterMirrored(const BlockMatrix& matrix, int slice, double scale, const LaneVectors& v,
                                           Vectors* to) {
  const LaneVectors scaled = {scale * v[0], scale * v[1], scale * v[2]};
  const std::ptrdiff_t begin = matrix.pattern->first[slice];
  const int* columns = matrix.pattern->columns.data() + kLanes * begin;
  const BlockLanes* const end = matrix.values.data() + matrix.pattern->first[slice + 1];
  for (const BlockLanes* blocks = matrix.values.data() + begin; blocks != end; ++blocks, columns += kLanes) {
    LaneVectors product;
    mirroredProduct(*blocks, scaled, product);
    scatterAdd(product, columns, to);
  }
}

/// sum += scale * blocks off the diagonal * v.
TISSUE_CONTACT_INLINE void addOffDiagonalProduct(const BlockMatrix& matrix, double scale, const NodalVectors& v,
                                                 NodalVectors& sum) {
  for (int slice = 0; slice < matrix.pattern->slices(); ++slice) {
    const int* const rows = rowsOf(*matrix.pattern, slice);
    LaneVectors own;
    gather(v.data(), rows, own);
    LaneVectors upper{};
    addUpperProduct(matrix, slice, v.data(), upper);
    const LaneVectors product = {scale * upper[0], scale * upper[1], scale * upper[2]};
    scatterAdd(product, rows, sum.data());
    scatterMirrored(matrix, slice, scale, own, sum.data());
  }
}

}  // namespace tissue_contact
