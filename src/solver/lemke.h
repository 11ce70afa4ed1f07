/// @file
/// Room `solver`, private: linear complementarity problems by Lemke's method. M and q in; z out.
#pragma once

#include <Eigen/Core>

namespace tissue_contact {

enum class LcpStatus {
  kSolved,
  kRay,        ///< secondary ray: M is of a class for which no solution is guaranteed, or round-off won
  kPivotLimit  ///< gave up after as many pivots as allowed
};

struct LcpAnswer {
  LcpStatus status = LcpStatus::kPivotLimit;
  int pivots = 0;
};

/// w = M z + q, 0 <= w  _|_  z >= 0, by complementary pivoting with covering vector 1. Ties of the ratio test are
/// broken lexicographically, so that degenerate problems cannot cycle (Cottle, Pang & Stone 1992, sections 4.4 and
/// 4.9). Scale the problem before, so that the entries of M and q are about 1.
/// @param tableau n x (n + 2), in: M in columns 0 to n - 1, q in column n + 1; overwritten.
/// @param labels workspace, 2 n + 1; overwritten. @param z out, n; meaningful when solved. No allocation.
LcpAnswer solveLcp(const Eigen::Ref<Eigen::MatrixXd>& tableau, const Eigen::Ref<Eigen::VectorXi>& labels,
                   Eigen::Ref<Eigen::VectorXd> z, int max_pivots);

}  // namespace tissue_contact
