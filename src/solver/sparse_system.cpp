#include "solver/sparse_system.h"

namespace tissue_contact {
namespace {

void addLowerBlock(const Matrix3& block, int row, int column, std::vector<Eigen::Triplet<double>>& entries) {
  for (int j = 0; j < 3; ++j) {
    for (int i = row == column ? j : 0; i < 3; ++i) entries.emplace_back(row + i, column + j, block(i, j));
  }
}

void addLowerTriangle(const BlockMatrix& matrix, double scale, const std::vector<int>& first_row,
                      std::vector<Eigen::Triplet<double>>& entries) {
  for (int i = 0; i < matrix.rows(); ++i) {
    if (first_row[i] < 0) continue;
    addLowerBlock(scale * matrix.diagonal[i], first_row[i], first_row[i], entries);
    matrix.pattern->forRow(i, [&](int j, int place) {
      if (j < i && first_row[j] >= 0) addLowerBlock(scale * matrix.block(place), first_row[i], first_row[j], entries);
    });
  }
}

}  // namespace

void SparseSystem::assemble(const BodySystem& body) {
  first_row_.assign(body.K->rows(), -1);
  int rows = 0;
  for (int i = 0; i < body.K->rows(); ++i) {
    if ((*body.fixed)[i]) continue;
    first_row_[i] = rows;
    rows += 3;
  }
  std::vector<Eigen::Triplet<double>> entries;
  entries.reserve(9 * (body.K->pattern->lower.size() + body.K->rows()));
  addLowerTriangle(*body.K, body.stiffness_scale, first_row_, entries);
  if (body.D != nullptr) addLowerTriangle(*body.D, body.damping_scale, first_row_, entries);
  for (int i = 0; i < body.K->rows(); ++i) {
    if (first_row_[i] < 0) continue;
    for (int axis = 0; axis < 3; ++axis) entries.emplace_back(first_row_[i] + axis, first_row_[i] + axis, body.mass[i]);
  }
  A_.resize(rows, rows);
  A_.setFromTriplets(entries.begin(), entries.end());
}

void SparseSystem::gather(const NodalVectors& nodal, VectorX& rows) const {
  rows.resize(A_.rows());
  for (std::size_t i = 0; i < first_row_.size(); ++i) {
    if (first_row_[i] >= 0) rows.segment<3>(first_row_[i]) = nodal.col(static_cast<Eigen::Index>(i));
  }
}

void SparseSystem::scatterAdd(const VectorX& rows, NodalVectors& nodal) const {
  for (std::size_t i = 0; i < first_row_.size(); ++i) {
    if (first_row_[i] >= 0) nodal.col(static_cast<Eigen::Index>(i)) += rows.segment<3>(first_row_[i]);
  }
}

}  // namespace tissue_contact
