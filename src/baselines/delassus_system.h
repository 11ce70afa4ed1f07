/// @file
/// Room `baselines`, private: a step's contact problem with its bodies eliminated, and the way back to velocities.
#pragma once

#include <Eigen/SparseCholesky>
#include <deque>
#include <vector>

#include "solver/sparse_system.h"
#include "tissue_contact/baselines/delassus.h"

namespace tissue_contact {

/// W = J A^-1 J' with the rows' compliances, q = J A^-1 b - u_tool - required_u_n n, by sparse Cholesky.
class DelassusSystem {
 public:
  /// Contacts on nodes that cannot move get zero rows (q too): r = 0, open.
  /// @param contacts must outlive this object.
  /// @throws std::runtime_error naming the body whose A is not positive definite.
  /// @throws std::invalid_argument for more than kMostDenseContacts.
  explicit DelassusSystem(const ContactProblem& contacts);

  const DelassusProblem& problem() const { return problem_; }
  std::vector<CoulombLaw>& laws() { return problem_.laws; }

  /// v = A^-1 (b + J' r) per body, m/s; 0 at fixed nodes.
  /// @param r 3n, N s.
  void recoverVelocities(const VectorX& r, std::vector<NodalVectors>& v) const;

 private:
  struct Body {
    SparseSystem system;
    Eigen::SimplicialLLT<Eigen::SparseMatrix<double>> factor;  ///< cannot be moved
    VectorX free_velocity;                                     ///< A^-1 b
  };

  void addBody(const BodySystem& body);
  void addContact(Eigen::Index c);
  void addRelative(const ContactRow& row, std::size_t k, const Eigen::MatrixXd& v, Eigen::Ref<Eigen::MatrixXd> u) const;
  bool distribute(const ContactRow& row, std::size_t k, Eigen::MatrixXd& impulses) const;

  const ContactProblem& contacts_;
  std::deque<Body> bodies_;
  DelassusProblem problem_;
};

}  // namespace tissue_contact
