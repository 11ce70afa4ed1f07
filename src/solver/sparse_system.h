/// @file
/// Room `solver`, private: A of one body as a scalar sparse matrix over its free nodes, for factorisations.
#pragma once

#include <Eigen/SparseCore>
#include <vector>

#include "tissue_contact/solver/contact_problem.h"

namespace tissue_contact {

class SparseSystem {
 public:
  /// Lower triangle of A = diag(mass) + stiffness_scale K + damping_scale D. Allocates.
  void assemble(const BodySystem& body);

  const Eigen::SparseMatrix<double>& matrix() const { return A_; }
  Eigen::Index size() const { return A_.rows(); }

  /// First of a node's three rows, -1 for a fixed node.
  int firstRow(int node) const { return first_row_[node]; }

  /// Free nodes' columns of `nodal` into a vector of rows, and a vector of rows added to them.
  void gather(const NodalVectors& nodal, VectorX& rows) const;
  void scatterAdd(const VectorX& rows, NodalVectors& nodal) const;

 private:
  std::vector<int> first_row_;
  Eigen::SparseMatrix<double> A_;
};

}  // namespace tissue_contact
