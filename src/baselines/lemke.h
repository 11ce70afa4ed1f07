/// @file
/// Room `baselines`, private: linear complementarity problems by Lemke's method. M and q in; z out.
#pragma once

#include <Eigen/Core>

namespace tissue_contact {

struct LcpAnswer {
  bool solved = false;  ///< no: out of pivots, or a secondary ray (M guarantees no solution, or round-off won)
  int pivots = 0;
};

/// w = M z + q, 0 <= w  _|_  z >= 0, by complementary pivoting with covering vector 1. Ties of the ratio test are
/// broken lexicographically, so that degenerate problems cannot cycle (Cottle, Pang & Stone 1992, sections 4.4 and
/// 4.9). Scale the problem before, so that the entries of M and q are about 1. No allocation.
/// @param tableau n x (n + 2), in: M in columns 0 to n - 1, q in column n + 1; overwritten.
/// @param labels workspace, 2 n + 1; overwritten.
/// @param z out, n; meaningful when solved.
LcpAnswer solveLcp(const Eigen::Ref<Eigen::MatrixXd>& tableau, const Eigen::Ref<Eigen::VectorXi>& labels,
                   Eigen::Ref<Eigen::VectorXd> z, int max_pivots);

}  // namespace tissue_contact
