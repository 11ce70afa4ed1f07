/// Blocks of the neo-Hookean stiffness, four elements at a time, against the simple version and against what they are for.
#include "tissue/neo_hookean_tangent.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/LU>
#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <vector>

namespace tissue_contact {
namespace {

constexpr double kMu = 2300.0;  // of E = 5000 Pa
constexpr double kVolume = 1e-9;

struct Case {
  std::string name;
  TangentPoint point;
  Matrix3 rest_inverse;
};

Matrix3 randomMatrix(std::mt19937& random, double size) {
  std::uniform_real_distribution<double> uniform(-size, size);
  Matrix3 matrix;
  for (Eigen::Index i = 0; i < 9; ++i) matrix.data()[i] = uniform(random);
  return matrix;
}

Matrix3 randomRotation(std::mt19937& random) {
  std::normal_distribution<double> normal;
  Eigen::Quaterniond q(normal(random), normal(random), normal(random), normal(random));
  return q.normalized().toRotationMatrix();
}

/// A tetrahedron of some millimetres.
Matrix3 randomRestInverse(std::mt19937& random) { return 1e3 * (Matrix3::Identity() + randomMatrix(random, 0.3)); }

std::vector<Case> cases() {
  std::mt19937 random(7);
  std::vector<Case> all;
  const auto add = [&](const std::string& name, const Matrix3& F) {
    for (const double lambda : {1500.0, 16000.0, 800000.0}) {  // nu up to .499
      for (const double flat_modulus : {0.0, 8.0 * kMu}) {
        for (const double pressure : {0.0, -3000.0, 5000.0}) {
          all.push_back({name, {F, {lambda, kMu}, {pressure, flat_modulus}}, randomRestInverse(random)});
        }
      }
    }
  };
  add("at rest", Matrix3::Identity());
  add("turned", randomRotation(random));
  add("two alike", randomRotation(random) * Vector3(0.7, 1.3, 0.7).asDiagonal());
  add("two alike after a turn", Vector3(1.2, 1.2, 0.6).asDiagonal() * randomRotation(random));
  add("swollen", 1.4 * randomRotation(random));
  add("turned inside out", Vector3(1.0, 1.0, -1.0).asDiagonal() * randomRotation(random));
  add("flat", randomRotation(random) * Vector3(1.0, 0.8, 0.0).asDiagonal() * randomRotation(random));
  add("tiny", 1e-29 * randomRotation(random) * Vector3(1.0, 0.5, 0.7).asDiagonal() * randomRotation(random));
  add("huge", 1e29 * randomRotation(random) * Vector3(1.0, 0.5, 0.7).asDiagonal() * randomRotation(random));
  add("nearly a line", randomRotation(random) * Vector3(3.0, 1e-3, -1e-3).asDiagonal() * randomRotation(random));
  for (int k = 0; k < 100; ++k) {
    add("a little deformed", randomRotation(random) * (Matrix3::Identity() + randomMatrix(random, 0.01)));
    add("deformed", randomRotation(random) * (Matrix3::Identity() + randomMatrix(random, 0.5)));
    add("anything", randomMatrix(random, 3.0));
  }
  return all;
}

void place(const Case& from, std::size_t lane, TangentLanes& lanes) {
  for (std::size_t i = 0; i < 9; ++i) {
    lanes.F[i][lane] = from.point.F.data()[i];
    lanes.rest_inverse[i][lane] = from.rest_inverse.data()[i];
  }
  lanes.volume[lane] = kVolume;
  lanes.lambda[lane] = from.point.material.lambda;
  lanes.mu[lane] = from.point.material.mu;
  lanes.pressure[lane] = from.point.patch.pressure;
  lanes.flat_modulus[lane] = from.point.patch.flat_modulus;
}

Eigen::Matrix<double, 3, 4> gradients(const Case& from) {
  Eigen::Matrix<double, 3, 4> all;
  all.rightCols<3>() = from.rest_inverse.transpose();
  all.col(0) = -all.rightCols<3>().rowwise().sum();
  return all;
}

Matrix3 inLane(const TangentLanes& lanes, std::size_t block, std::size_t lane) {
  Matrix3 matrix;
  for (std::size_t i = 0; i < 9; ++i) matrix.data()[i] = lanes.blocks[block][i][lane];
  return matrix;
}

Eigen::Matrix<double, 12, 12> whole(const TangentLanes& lanes, std::size_t lane) {
  Eigen::Matrix<double, 12, 12> K;
  std::size_t block = 0;
  for (int n = 0; n < 4; ++n) {
    for (int m = n; m < 4; ++m) {
      K.block<3, 3>(3 * n, 3 * m) = inLane(lanes, block++, lane);
      if (m > n) K.block<3, 3>(3 * m, 3 * n) = K.block<3, 3>(3 * n, 3 * m).transpose();
    }
  }
  return K;
}

// 1e-10: singular values come from F'F, whose round-off of 1e-16 is as much of the smallest one squared, 1e-6 of the largest in
// "nearly a line".
TEST(NeoHookeanTangent, OfFourElementsIsThatOfOne) {
  const std::vector<Case> all = cases();
  ASSERT_EQ(all.size() % kLanes, 0u);
  for (std::size_t first = 0; first < all.size(); first += kLanes) {
    TangentLanes lanes = {};
    for (std::size_t lane = 0; lane < kLanes; ++lane) place(all[first + lane], lane, lanes);
    ASSERT_EQ(computeTangents(lanes), 0) << all[first].name;
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      const Case& one = all[first + lane];
      const TangentBlocks simple = tangentBlocks(one.point, gradients(one), kVolume);
      double size = 0.0;
      double off = 0.0;
      for (std::size_t k = 0; k < kTangentBlocks; ++k) {
        size = std::max(size, simple[k].norm());
        off = std::max(off, (inLane(lanes, k, lane) - simple[k]).norm());
      }
      EXPECT_LT(off, 1e-10 * size) << one.name << ":\n" << one.point.F;
    }
  }
}

TEST(NeoHookeanTangent, HasNoNegativeEigenvalue) {
  for (const Case& one : cases()) {
    TangentLanes lanes = {};
    place(one, 2, lanes);
    computeTangents(lanes);
    const auto values = Eigen::SelfAdjointEigenSolver<Eigen::Matrix<double, 12, 12>>(whole(lanes, 2)).eigenvalues();
    EXPECT_GE(values.minCoeff(), -1e-10 * values.maxCoeff()) << one.name << ":\n" << one.point.F;
    EXPECT_GT(values.maxCoeff(), 0.0);
  }
}

// What is added is taken out again, four others beside it.
TEST(NeoHookeanTangent, OfALaneIsTheSameWhateverTheOthersAre) {
  const std::vector<Case> all = cases();
  for (std::size_t k = 0; k < all.size(); ++k) {
    TangentLanes together = {};
    for (std::size_t lane = 0; lane < kLanes; ++lane) place(all[(k + 37 * lane) % all.size()], lane, together);
    computeTangents(together);
    TangentLanes alone = {};
    place(all[k], 3, alone);
    computeTangents(alone);
    for (std::size_t block = 0; block < kTangentBlocks; ++block) {
      EXPECT_EQ(inLane(together, block, 0), inLane(alone, block, 3)) << all[k].name;
    }
  }
}

TEST(NeoHookeanTangent, TellsWhereItMeansNothing) {
  std::mt19937 random(3);
  const Matrix3 line = Vector3(1.0, 0.2, -0.4) * Vector3(0.3, 1.0, 0.1).transpose();
  TangentLanes lanes = {};
  const double infinity = std::numeric_limits<double>::infinity();
  const std::vector<Matrix3> gradients = {line, Matrix3::Zero(), 1e31 * Matrix3::Identity(),
                                          infinity * Matrix3::Ones()};
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    place({"", {gradients[lane], {16000.0, kMu}, {}}, randomRestInverse(random)}, lane, lanes);
  }
  EXPECT_EQ(computeTangents(lanes), 0b1111);
  place({"", {Matrix3::Identity(), {16000.0, kMu}, {}}, randomRestInverse(random)}, 1, lanes);
  EXPECT_EQ(computeTangents(lanes), 0b1101);
}

}  // namespace
}  // namespace tissue_contact
