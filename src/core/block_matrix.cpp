#include "tissue_contact/core/block_matrix.h"

#include <algorithm>

namespace tissue_contact {

int BlockMatrix::find(int row, int column) const {
  const auto first = columns.begin() + row_start[row];
  const auto last = columns.begin() + row_start[row + 1];
  const auto it = std::lower_bound(first, last, column);
  return it != last && *it == column ? static_cast<int>(it - columns.begin()) : -1;
}

BlockMatrix BlockMatrix::forTetrahedra(const std::vector<Tetrahedron>& tetrahedra, const std::vector<bool>& fixed) {
  const int nodes = static_cast<int>(fixed.size());
  std::vector<std::vector<int>> neighbours(nodes);
  for (const Tetrahedron& tet : tetrahedra) {
    for (const int a : tet) {
      for (const int b : tet) {
        if (a != b && !fixed[a] && !fixed[b]) neighbours[a].push_back(b);
      }
    }
  }
  BlockMatrix matrix;
  matrix.diagonal.resize(nodes);
  matrix.row_start.reserve(nodes + 1);
  matrix.row_start.push_back(0);
  for (std::vector<int>& row : neighbours) {
    std::sort(row.begin(), row.end());
    row.erase(std::unique(row.begin(), row.end()), row.end());
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

}  // namespace tissue_contact
