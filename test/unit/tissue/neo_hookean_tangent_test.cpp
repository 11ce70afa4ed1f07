/// Blocks of the neo-Hookean stiffness, four elements or patches at a time, against the simple version and against what they are for.
#include "tissue/neo_hookean_tangent.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <array>
#include <cmath>
#include <limits>
#include <random>
#include <string>
#include <vector>

namespace tissue_contact {
namespace neo_hookean_tangent_test {

constexpr double kMu = 2300.0;  // of E = 5000 Pa
constexpr double kVolume = 1e-9;

// Nodes: those of a tetrahedron, and as many as a patch of five has.
constexpr std::size_t kNodes = 8;

using Gradients = Eigen::Matrix<double, 3, kNodes>;

struct Case {
  std::string name;
  TangentPoint point;
  Gradients gradients;
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

/// Of an element of some millimetres: gradients sum to zero.
Gradients randomGradients(std::mt19937& random) {
  std::uniform_real_distribution<double> uniform(-1e3, 1e3);
  Gradients gradients;
  for (Eigen::Index i = 0; i < gradients.size(); ++i) gradients.data()[i] = uniform(random);
  gradients.colwise() -= gradients.rowwise().mean().eval();
  return gradients;
}

std::vector<Case> cases() {
  std::mt19937 random(7);
  std::vector<Case> all;
  const auto add = [&](const std::string& name, const Matrix3& F) {
    for (const double lambda : {1500.0, 16000.0, 800000.0}) {  // nu up to .499
      for (const double flat_modulus : {0.0, 8.0 * kMu}) {
        for (const double pressure : {0.0, -3000.0, 5000.0}) {
          all.push_back({name, {F, {lambda, kMu}, {pressure, flat_modulus}}, randomGradients(random)});
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

/// Four cases side by side and what is computed of them.
class FourLanes {
 public:
  void place(const Case& from, std::size_t lane) {
    for (std::size_t i = 0; i < 9; ++i) lanes_.F[i][lane] = from.point.F.data()[i];
    lanes_.volume[lane] = kVolume;
    lanes_.lambda[lane] = from.point.material.lambda;
    lanes_.mu[lane] = from.point.material.mu;
    lanes_.pressure[lane] = from.point.patch.pressure;
    lanes_.flat_modulus[lane] = from.point.patch.flat_modulus;
    for (std::size_t n = 0; n < kNodes; ++n) {
      for (std::size_t k = 0; k < 3; ++k) {
        gradients_[n][k][lane] = from.gradients(static_cast<Eigen::Index>(k), static_cast<Eigen::Index>(n));
      }
    }
  }

  unsigned char compute() { return computeTangents(lanes_, gradients_.data(), kNodes, turned_.data(), blocks_.data()); }

  /// @param n, m n <= m.
  Matrix3 block(std::size_t n, std::size_t m, std::size_t lane) const {
    Matrix3 matrix;
    for (std::size_t i = 0; i < 9; ++i) matrix.data()[i] = blocks_[n * (2 * kNodes - n - 1) / 2 + m][i][lane];
    return matrix;
  }

  Eigen::MatrixXd whole(std::size_t lane) const {
    Eigen::MatrixXd K(3 * kNodes, 3 * kNodes);
    for (std::size_t n = 0; n < kNodes; ++n) {
      for (std::size_t m = n; m < kNodes; ++m) {
        const auto row = static_cast<Eigen::Index>(3 * n);
        const auto column = static_cast<Eigen::Index>(3 * m);
        K.block<3, 3>(row, column) = block(n, m, lane);
        if (m > n) K.block<3, 3>(column, row) = block(n, m, lane).transpose();
      }
    }
    return K;
  }

 private:
  TangentLanes lanes_ = {};
  std::array<GradientLanes, kNodes> gradients_ = {};
  std::array<GradientLanes, kNodes> turned_ = {};
  std::array<MatrixBatch, kNodes*(kNodes + 1) / 2> blocks_ = {};
};

// 1e-10: singular values come from F'F, whose round-off of 1e-16 is as much of the smallest one squared, 1e-6 of the largest in
// "nearly a line".
TEST(NeoHookeanTangent, OfFourElementsIsThatOfOne) {
  const std::vector<Case> all = cases();
  ASSERT_EQ(all.size() % kLanes, 0u);
  for (std::size_t first = 0; first < all.size(); first += kLanes) {
    FourLanes lanes;
    for (std::size_t lane = 0; lane < kLanes; ++lane) lanes.place(all[first + lane], lane);
    ASSERT_EQ(lanes.compute(), 0) << all[first].name;
    for (std::size_t lane = 0; lane < kLanes; ++lane) {
      const Case& one = all[first + lane];
      const Tangent simple(one.point);
      double size = 0.0;
      double off = 0.0;
      for (std::size_t n = 0; n < kNodes; ++n) {
        for (std::size_t m = n; m < kNodes; ++m) {
          const Matrix3 expected = kVolume * simple.block(one.gradients.col(static_cast<Eigen::Index>(n)),
                                                          one.gradients.col(static_cast<Eigen::Index>(m)));
          size = std::max(size, expected.norm());
          off = std::max(off, (lanes.block(n, m, lane) - expected).norm());
        }
      }
      EXPECT_LT(off, 1e-10 * size) << one.name << ":\n" << one.point.F;
    }
  }
}

TEST(NeoHookeanTangent, HasNoNegativeEigenvalue) {
  for (const Case& one : cases()) {
    FourLanes lanes;
    lanes.place(one, 2);
    lanes.compute();
    const auto values = Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd>(lanes.whole(2)).eigenvalues();
    EXPECT_GE(values.minCoeff(), -1e-10 * values.maxCoeff()) << one.name << ":\n" << one.point.F;
    EXPECT_GT(values.maxCoeff(), 0.0);
  }
}

// What is added is taken out again, four others beside it.
TEST(NeoHookeanTangent, OfALaneIsTheSameWhateverTheOthersAre) {
  const std::vector<Case> all = cases();
  for (std::size_t k = 0; k < all.size(); ++k) {
    FourLanes together;
    for (std::size_t lane = 0; lane < kLanes; ++lane) together.place(all[(k + 37 * lane) % all.size()], lane);
    together.compute();
    FourLanes alone;
    alone.place(all[k], 3);
    alone.compute();
    EXPECT_EQ(together.whole(0), alone.whole(3)) << all[k].name;
  }
}

TEST(NeoHookeanTangent, TellsWhereItMeansNothing) {
  std::mt19937 random(3);
  const Matrix3 line = Vector3(1.0, 0.2, -0.4) * Vector3(0.3, 1.0, 0.1).transpose();
  FourLanes lanes;
  const double infinity = std::numeric_limits<double>::infinity();
  const std::vector<Matrix3> gradients = {line, Matrix3::Zero(), 1e31 * Matrix3::Identity(),
                                          infinity * Matrix3::Ones()};
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    lanes.place({"", {gradients[lane], {16000.0, kMu}, {}}, randomGradients(random)}, lane);
  }
  EXPECT_EQ(lanes.compute(), 0b1111);
  lanes.place({"", {Matrix3::Identity(), {16000.0, kMu}, {}}, randomGradients(random)}, 1);
  EXPECT_EQ(lanes.compute(), 0b1101);
}

// Blown up to twice its size, all shears of it would release energy, by -16 mu. With no stiffness against the stress of such a state, tissue
// that is torn went to 1e23 m.
TEST(NeoHookeanTangent, WhatIsFarFromStableIsStiff) {
  const LameParameters material = {2000.0, 1500.0};
  const Tangent tangent({2.0 * Matrix3::Identity(), material, {}});
  const double along_F = material.mu - material.mu / 13.0;
  const double value = along_F - 2.0 * (7.0 * material.lambda - 0.75 * material.mu);
  ASSERT_LT(value, -10.0 * material.mu);
  const Vector3 x = Vector3::UnitX(), y = Vector3::UnitY();  // dF = y x' + x y'
  const double sheared =
      y.dot(tangent.block(x, x) * y) + x.dot(tangent.block(y, y) * x) + 2.0 * y.dot(tangent.block(x, y) * x);
  EXPECT_NEAR(sheared, 2.0 * (-value - material.mu), 1e-9 * material.mu);
  const Tangent nearly({1.3 * Matrix3::Identity(), {2226.0, 1500.0}, {}});  // negative, but by less than mu: nothing
  EXPECT_NEAR(y.dot(nearly.block(x, x) * y) + x.dot(nearly.block(y, y) * x) + 2.0 * y.dot(nearly.block(x, y) * x), 0.0,
              1e-9);
}

}  // namespace neo_hookean_tangent_test
}  // namespace tissue_contact
