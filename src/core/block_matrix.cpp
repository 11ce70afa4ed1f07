#include "tissue_contact/core/block_matrix.h"

#include <algorithm>
#include <cstddef>

#include "core/row_product.h"

namespace tissue_contact {

int BlockMatrix::find(int row, int column) const {
  const auto first = columns.begin() + row_start[row];
  const auto last = columns.begin() + row_start[row + 1];
  const auto it = std::lower_bound(first, last, column);
  return it != last && *it == column ? static_cast<int>(it - columns.begin()) : -1;
}

BlockMatrix BlockMatrix::fromNeighbours(std::vector<std::vector<int>>& neighbours) {
  BlockMatrix matrix;
  matrix.diagonal.resize(neighbours.size());
  matrix.row_start.reserve(neighbours.size() + 1);
  matrix.row_start.push_back(0);
  matrix.row_middle.reserve(neighbours.size());
  for (std::vector<int>& row : neighbours) {
    std::sort(row.begin(), row.end());
    row.erase(std::unique(row.begin(), row.end()), row.end());
    const int node = static_cast<int>(matrix.row_middle.size());
    const auto before = std::lower_bound(row.begin(), row.end(), node) - row.begin();
    matrix.row_middle.push_back(static_cast<int>(static_cast<std::ptrdiff_t>(matrix.columns.size()) + before));
    matrix.columns.insert(matrix.columns.end(), row.begin(), row.end());
    matrix.row_start.push_back(static_cast<int>(matrix.columns.size()));
  }
  matrix.values.resize(matrix.columns.size());
  matrix.setZero();
  return matrix;
}

void BlockMatrix::setZero() {
  std::fill(diagonal.begin(), diagonal.end(), Matrix3::Zero());
  std::fill(values.begin(), values.end(), Matrix3::Zero());
}

void BlockMatrix::copyBlocks(const BlockMatrix& from) {
  std::copy(from.diagonal.begin(), from.diagonal.end(), diagonal.begin());
  std::copy(from.values.begin(), from.values.end(), values.begin());
}

TISSUE_CONTACT_CLONES
Vector3 BlockMatrix::offDiagonalProduct(int i, const NodalVectors& v) const {
  return rowProduct(*this, row_start[i], row_start[i + 1], v);
}

TISSUE_CONTACT_CLONES
Vector3 BlockMatrix::lowerProduct(int i, const NodalVectors& v) const {
  return rowProduct(*this, row_start[i], row_middle[i], v);
}

TISSUE_CONTACT_CLONES
Vector3 BlockMatrix::upperProduct(int i, const NodalVectors& v) const {
  return rowProduct(*this, row_middle[i], row_start[i + 1], v);
}

}  // namespace tissue_contact
