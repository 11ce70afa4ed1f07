/// @file
/// Room `solver`, private: one body's A factored at some earlier step, and the compliance P^-1 between its touched nodes.
#pragma once

#include <Eigen/SparseCholesky>
#include <vector>

#include "solver/sparse_system.h"

namespace tissue_contact {

/// The compliance C = (P^-1)_SS grows by one column per newly touched node. It is symmetric, so the rows that earlier
/// columns lack are in the new column. It lives as long as the factor.
class FactoredBody {
 public:
  /// Begins a step: renews the factor if it is stale or A has changed too much.
  /// @return it did.
  bool prepare(const BodySystem& body);
  void renew(const BodySystem& body);  ///< factors A of this step; allocates
  void markStale() { stale_ = true; }  ///< renew at the next prepare()

  /// v += P^-1 defect.
  void relax(const NodalVectors& defect, NodalVectors& v);

  /// Begins the contacts of a step: forgets touched nodes where they have become too many.
  void beginTouching();
  /// Index of a node in S, added if it is new (three back-substitutions in one); -1 for a fixed node.
  int touch(int node);
  /// Block between two nodes of S, 1/kg.
  Matrix3 compliance(int a, int b) const { return C_.block<3, 3>(3 * Eigen::Index{a}, 3 * Eigen::Index{b}); }

  /// Velocities of S, m/s; and what an impulse (N s, world axes) at one of them adds.
  void gatherTouched(const NodalVectors& v, VectorX& velocities) const;
  void addResponse(int touched, const Vector3& impulse_W, VectorX& velocities) const;

 private:
  void forget();
  void solve();
  void solveForNode(int row);

  SparseSystem system_;
  Eigen::SimplicialLLT<Eigen::SparseMatrix<double>> factor_;
  bool analysed_ = false;
  bool valid_ = false;
  bool stale_ = false;
  double stiffness_scale_ = 0.0;
  double damping_scale_ = 0.0;
  double total_mass_ = 0.0;
  VectorX right_;
  VectorX permuted_;
  VectorX left_;
  Eigen::Matrix<double, Eigen::Dynamic, 3, Eigen::RowMajor> columns_;
  std::vector<int> index_of_;  ///< per node: index into touched_, else -1
  std::vector<int> touched_;   ///< S
  std::size_t touched_before_ = 0;
  Eigen::MatrixXd C_;  ///< the first 3 |S| rows and columns mean something
};

}  // namespace tissue_contact
