/// @file
/// Room `core`: sparse symmetric matrix of 3x3 blocks over the nodes of a mesh, rows compressed, diagonal apart.
#pragma once

#include <vector>

#include "tissue_contact/core/types.h"

namespace tissue_contact {

/// Rows and columns are nodes. The four vectors of indices and blocks belong together; forElements() makes them. Both triangles are stored, so that a row is all a Gauss-Seidel sweep needs to read.
struct BlockMatrix {
  std::vector<Matrix3> diagonal;  ///< one per node
  std::vector<int> row_start;     ///< nodes + 1 offsets into `columns` and `values`
  std::vector<int> row_middle;    ///< per node the offset of its first column beyond the diagonal
  std::vector<int> columns;       ///< ascending within a row, never the row itself
  std::vector<Matrix3> values;

  int rows() const { return static_cast<int>(diagonal.size()); }

  /// Index into `values` of block (row, column), -1 when it is not stored.
  int find(int row, int column) const;

  /// Zero matrix with a block for every pair of free nodes that share an element (a range of node indices). Fixed nodes
  /// get no off-diagonal.
  template <typename Elements>
  static BlockMatrix forElements(const Elements& elements, const std::vector<bool>& fixed) {
    std::vector<std::vector<int>> neighbours(fixed.size());
    for (const auto& element : elements) {
      for (const int a : element) {
        for (const int b : element) {
          if (a != b && !fixed[a] && !fixed[b]) neighbours[a].push_back(b);
        }
      }
    }
    return fromNeighbours(neighbours);
  }
  static BlockMatrix forTetrahedra(const std::vector<Tetrahedron>& tetrahedra, const std::vector<bool>& fixed) {
    return forElements(tetrahedra, fixed);
  }

  void setZero();

  /// Takes over the blocks of a matrix of the same pattern. No allocation.
  void copyBlocks(const BlockMatrix& from);

  /// Sum over off-diagonal blocks of row `i`: sum_j values * v_j.
  Vector3 offDiagonalProduct(int i, const NodalVectors& v) const;
  Vector3 lowerProduct(int i, const NodalVectors& v) const;  ///< over j < i only
  Vector3 upperProduct(int i, const NodalVectors& v) const;  ///< over j > i only

 private:
  /// @param neighbours of each node; may name a node twice. Sorted on the way.
  static BlockMatrix fromNeighbours(std::vector<std::vector<int>>& neighbours);
};

}  // namespace tissue_contact
