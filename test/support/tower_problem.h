/// @file
/// Towers of rigid blocks, for tests: contact problems whose W has far less than full rank.
#pragma once

#include <cmath>
#include <random>

#include "tissue_contact/baselines/delassus.h"

namespace tissue_contact {

/// Eight blocks on top of one another, three contacts under each: 24 contacts, W 72 x 72 of rank 48. Masses differ by a
/// factor of about 2, contact normals lean by about 0.1 rad, the blocks come down at 0.1 m/s and slide as fast. Same seed,
/// same problem, on any standard library.
inline DelassusProblem towerProblem(double mu, unsigned seed) {
  constexpr int kBlocks = 8;
  constexpr int kContacts = 3 * kBlocks;
  std::mt19937 random(seed);
  const auto normal = [&] {  // nearly: the sum of twelve uniform numbers
    double sum = -6.0;
    for (int i = 0; i < 12; ++i) sum += static_cast<double>(random()) / 4294967296.0;
    return sum;
  };
  Eigen::MatrixXd J = Eigen::MatrixXd::Zero(3 * kContacts, 6 * kBlocks);
  VectorX compliance(6 * kBlocks);
  VectorX v = VectorX::Zero(6 * kBlocks);
  for (int block = 0; block < kBlocks; ++block) {
    const double mass = std::pow(10.0, 0.3 * normal());
    compliance.segment<3>(6 * block).setConstant(1.0 / mass);
    compliance.segment<3>(6 * block + 3).setConstant(1.0 / (0.001 * mass));
    v.segment<3>(6 * block) = Vector3(0.1 * normal(), 0.1 * normal(), -0.1);
    for (int k = 0; k < 3; ++k) {
      const Vector3 n = Vector3(0.1 * normal(), 0.1 * normal(), 1.0).normalized();
      Matrix3 R_WC;
      R_WC << n, n.cross(Vector3::UnitX()).normalized(), n.cross(n.cross(Vector3::UnitX())).normalized();
      const double angle = 2.0 * M_PI / 3.0 * k;
      for (const int side : {0, 1}) {  // this block's lower face; the upper face of the one below
        if (block - side < 0) continue;
        const Vector3 arm(0.05 * std::cos(angle), 0.05 * std::sin(angle), side == 0 ? -0.05 : 0.05);
        Matrix3 turning;  // v = velocity - arm x rotation
        turning << 0.0, arm.z(), -arm.y(), -arm.z(), 0.0, arm.x(), arm.y(), -arm.x(), 0.0;
        const double sign = side == 0 ? 1.0 : -1.0;
        J.block<3, 3>(9 * block + 3 * k, 6 * (block - side)) = sign * R_WC.transpose();
        J.block<3, 3>(9 * block + 3 * k, 6 * (block - side) + 3) = sign * R_WC.transpose() * turning;
      }
    }
  }
  DelassusProblem problem;
  problem.W = J * compliance.asDiagonal() * J.transpose();
  problem.q = J * v;
  problem.laws.resize(kContacts);
  for (CoulombLaw& law : problem.laws) law.mu_static = law.mu_kinetic = mu;
  problem.was_sliding.assign(kContacts, false);
  return problem;
}

}  // namespace tissue_contact
