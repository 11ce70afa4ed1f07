/// @file
/// Contact problems with random symmetric positive definite W, and descriptions of who solves them, for tests and the
/// solver table.
#pragma once

#include <random>

#include "tissue_contact/baselines/delassus.h"

namespace tissue_contact {

/// W = B B' / 3n + 0.001 I, entries of B normal: condition numbers of 10^3 to 10^4 and normal directions coupled to
/// tangential ones as strongly as anything else. q normal, closing by 0.5 on average. Same seed, same problem.
inline DelassusProblem randomContactProblem(int contacts, double mu, unsigned seed) {
  std::mt19937 random(seed);
  std::normal_distribution<double> normal;
  const int rows = 3 * contacts;
  Eigen::MatrixXd B(rows, rows);
  for (Eigen::Index i = 0; i < B.size(); ++i) B(i) = normal(random);
  DelassusProblem problem;
  problem.W.noalias() = B * B.transpose() / rows;
  problem.W.diagonal().array() += 0.001;
  problem.q.resize(rows);
  for (int i = 0; i < rows; ++i) problem.q[i] = normal(random) - (i % 3 == 0 ? 0.5 : 0.0);
  problem.laws.resize(contacts);
  for (CoulombLaw& law : problem.laws) law.mu_static = law.mu_kinetic = mu;
  problem.was_sliding.assign(contacts, false);
  return problem;
}

inline SolverDescription solver(SolverMethod method, double tolerance = 1e-10, int iterations = 3000) {
  SolverDescription description;
  description.method = method;
  description.tolerance = tolerance;
  description.iterations = iterations;
  return description;
}

}  // namespace tissue_contact
