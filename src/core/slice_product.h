/// @file
/// Room `core`, private: products with four rows of a BlockMatrix at a time, one row per lane, for loops that are built
/// for several vector widths. Every lane does what the plain product does in the same order, so the bits do not depend
/// on the width.
#pragma once

#include <array>
#include <cstddef>
#include <cstring>

#include "core/lanes.h"
#include "tissue_contact/core/block_matrix.h"

namespace tissue_contact {

static_assert(BlockPattern::kRows == kLanes, "a row of a slice is a lane");

/// A vector per lane: x, y, z.
using LaneVectors = Lanes[3];

/// The same in memory.
struct alignas(32) SliceVectors {
  std::array<std::array<double, kLanes>, 3> at;
};

TISSUE_CONTACT_INLINE void load(const double* from, Lanes& to) { std::memcpy(&to, from, sizeof(Lanes)); }

TISSUE_CONTACT_INLINE void load(const SliceVectors& from, LaneVectors& to) {
  load(from.at[0].data(), to[0]);
  load(from.at[1].data(), to[1]);
  load(from.at[2].data(), to[2]);
}

TISSUE_CONTACT_INLINE void load(const BlockLanes& from, Lanes (&to)[9]) {
  // One by one: copied at once or in a loop, they would go through the stack.
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

/// Coordinate r of four columns of `v`, 3 x nodes. @param at where they begin.
TISSUE_CONTACT_INLINE void gather(const double* v, const int* at, std::size_t r, Lanes& to) {
  const double* const w = v + r;
  to = Lanes{w[at[0]], w[at[1]], w[at[2]], w[at[3]]};
}

TISSUE_CONTACT_INLINE void gather(const double* v, const int* at, LaneVectors& to) {
  Lanes x, y, z;
  gather(v, at, 0, x);
  gather(v, at, 1, y);
  gather(v, at, 2, z);
  to[0] = x;
  to[1] = y;
  to[2] = z;
}

/// Lane by lane, for two rows may share a column; x and y as a pair.
TISSUE_CONTACT_INLINE void scatterAdd(const LaneVectors& from, const int* at, double* v) {
  using Pair = double __attribute__((vector_size(2 * sizeof(double))));
  const Lanes even = TISSUE_CONTACT_SHUFFLE(from[0], from[1], 0, 4, 2, 6);  // x, y of lanes 0 and 2
  const Lanes odd = TISSUE_CONTACT_SHUFFLE(from[0], from[1], 1, 5, 3, 7);
  const Pair pairs[kLanes] = {{even[0], even[1]}, {odd[0], odd[1]}, {even[2], even[3]}, {odd[2], odd[3]}};
  for (int lane = 0; lane < kLanes; ++lane) {
    double* const to = v + at[lane];
    Pair sum;
    std::memcpy(&sum, to, sizeof(Pair));
    sum += pairs[lane];
    std::memcpy(to, &sum, sizeof(Pair));
    // NOLINTNEXTLINE(clang-analyzer-core.uninitialized.Assign): it takes a body without nodes to have slices
    to[2] += from[2][lane];
  }
}

/// Where the coordinates of a slice's rows begin.
TISSUE_CONTACT_INLINE std::array<int, kLanes> rowsOf(const BlockPattern& pattern, int slice) {
  const int* const rows = &pattern.rows[kLanes * static_cast<std::size_t>(slice)];
  return {3 * rows[0], 3 * rows[1], 3 * rows[2], 3 * rows[3]};
}

/// sum += blocks * v.
TISSUE_CONTACT_INLINE void addProduct(const BlockLanes& blocks, const LaneVectors& v, LaneVectors& sum) {
  Lanes m[9];
  load(blocks, m);
  sum[0] += m[0] * v[0] + m[3] * v[1] + m[6] * v[2];
  sum[1] += m[1] * v[0] + m[4] * v[1] + m[7] * v[2];
  sum[2] += m[2] * v[0] + m[5] * v[1] + m[8] * v[2];
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
TISSUE_CONTACT_INLINE void addUpperProduct(const BlockMatrix& matrix, int slice, const double* v, LaneVectors& sum) {
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
TISSUE_CONTACT_INLINE void scatterMirrored(const BlockMatrix& matrix, int slice, double scale, const LaneVectors& v,
                                           double* to) {
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

}  // namespace tissue_contact
