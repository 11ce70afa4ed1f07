/// @file
/// Room `core`, private: products of a block with a vector, four lanes at a time, for loops that are built for several vector widths. The
/// order of sums is that of the plain product, so the bits are the same.
#pragma once

#include <cstddef>
#include <cstring>

#include "core/lanes.h"
#include "tissue_contact/core/block_matrix.h"

namespace tissue_contact {

/// Columns of a block; the last lane of each is of no use to anyone.
TISSUE_CONTACT_INLINE void loadBlock(const Matrix3& block, Lanes& x, Lanes& y, Lanes& z) {
  const double* const m = block.data();
  std::memcpy(&x, m, sizeof(Lanes));
  std::memcpy(&y, m + 3, sizeof(Lanes));
  std::memcpy(&z, m + 5, sizeof(Lanes));  // not beyond the block
  z = TISSUE_CONTACT_SHUFFLE(z, z, 1, 2, 3, 3);
}

TISSUE_CONTACT_INLINE Vector3 blockProduct(const Matrix3& block, const Vector3& v) {
  Lanes x, y, z;
  loadBlock(block, x, y, z);
  const Lanes sum = x * v[0] + y * v[1] + z * v[2];
  return {sum[0], sum[1], sum[2]};
}

/// Sum of values * v_j over offsets [begin, end).
TISSUE_CONTACT_INLINE Vector3 rowProduct(const BlockMatrix& matrix, int begin, int end, const NodalVectors& v) {
  const double* const velocity = v.data();
  Lanes sum = {0.0, 0.0, 0.0, 0.0};
  for (int k = begin; k < end; ++k) {
    const double* const w = velocity + 3 * static_cast<std::ptrdiff_t>(matrix.columns[k]);
    Lanes x, y, z;
    loadBlock(matrix.values[k], x, y, z);
    sum += x * w[0] + y * w[1] + z * w[2];
  }
  return {sum[0], sum[1], sum[2]};
}

}  // namespace tissue_contact
