/// @file
/// Room `validation`: what cases and tests of elastic models share: dense matrices, forces of a position, static solutions.
#pragma once

#include <Eigen/SparseCholesky>
#include <memory>
#include <vector>

#include "tissue_contact/core/types.h"
#include "tissue_contact/tissue/elasticity.h"

namespace tissue_contact {

inline Eigen::MatrixXd dense(const BlockMatrix& K) {
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(3 * K.rows(), 3 * K.rows());
  for (int i = 0; i < K.rows(); ++i) {
    A.block<3, 3>(3 * i, 3 * i) = K.diagonal[i];
    K.pattern->forRow(i, [&](int j, int place) { A.block<3, 3>(3 * i, 3 * j) = K.block(place); });
  }
  return A;
}

/// Elastic forces at x, from a fresh state.
inline NodalVectors elasticForces(const Elasticity& elasticity, const NodalVectors& x) {
  const auto state = elasticity.makeState();
  NodalVectors f(3, x.cols());
  elasticity.update(x, *state, f);
  return f;
}

/// K u = f with some coordinates (3 per node) prescribed, by sparse Cholesky. K must have been assembled without fixed
/// nodes. @param u in: the prescribed coordinates; out: all of them.
inline void solveStatic(const BlockMatrix& K, const std::vector<bool>& prescribed, const NodalVectors& loads,
                        NodalVectors& u) {
  const auto size = static_cast<std::size_t>(u.size());
  std::vector<int> unknown(size, -1);
  int count = 0;
  for (std::size_t i = 0; i < size; ++i) {
    if (!prescribed[i]) unknown[i] = count++;
  }
  std::vector<Eigen::Triplet<double>> triplets;
  VectorX rhs = VectorX::Zero(count);
  const auto add = [&](int i, int j, const Matrix3& block) {
    for (int r = 0; r < 3; ++r) {
      const int row = unknown[3 * i + r];
      if (row < 0) continue;
      for (int c = 0; c < 3; ++c) {
        const int column = unknown[3 * j + c];
        if (column < 0) {
          rhs[row] -= block(r, c) * u(c, j);
        } else {
          triplets.emplace_back(row, column, block(r, c));
        }
      }
    }
  };
  for (int i = 0; i < K.rows(); ++i) {
    for (int r = 0; r < 3; ++r) {
      if (unknown[3 * i + r] >= 0) rhs[unknown[3 * i + r]] += loads(r, i);
    }
    add(i, i, K.diagonal[i]);
    K.pattern->forRow(i, [&](int j, int place) { add(i, j, K.block(place)); });
  }
  Eigen::SparseMatrix<double> A(count, count);
  A.setFromTriplets(triplets.begin(), triplets.end());
  const Eigen::SimplicialLDLT<Eigen::SparseMatrix<double>> cholesky(A);
  const VectorX solution = cholesky.solve(rhs);
  for (std::size_t i = 0; i < size; ++i) {
    if (unknown[i] >= 0) u.data()[i] = solution[unknown[i]];
  }
}

/// Equilibrium f(x) + loads = 0 by Newton with line search on the residual's energy, from x; the same coordinates
/// prescribed. Returns the largest residual force, N.
inline double solveEquilibrium(const Elasticity& elasticity, const std::vector<bool>& prescribed,
                               const NodalVectors& loads, int iterations, NodalVectors& x) {
  const auto state = elasticity.makeState();
  NodalVectors f(3, x.cols());
  const auto residual = [&](const NodalVectors& at) {
    elasticity.update(at, *state, f);
    NodalVectors r = f + loads;
    for (Eigen::Index i = 0; i < r.size(); ++i) {
      if (prescribed[static_cast<std::size_t>(i)]) r.data()[i] = 0.0;
    }
    return r;
  };
  NodalVectors r = residual(x);
  for (int iteration = 0; iteration < iterations; ++iteration) {
    NodalVectors step = NodalVectors::Zero(3, x.cols());
    solveStatic(state->stiffness, prescribed, r, step);
    const double before = elasticity.energy(x) - loads.cwiseProduct(x).sum();
    double scale = 1.0;
    while (scale > 1e-6 && elasticity.energy(x + scale * step) - loads.cwiseProduct(x + scale * step).sum() >
                               before + 1e-12 * std::abs(before)) {
      scale *= 0.5;
    }
    x += scale * step;
    r = residual(x);
  }
  return r.cwiseAbs().maxCoeff();
}

}  // namespace tissue_contact
