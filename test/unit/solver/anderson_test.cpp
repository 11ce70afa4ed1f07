/// Anderson's acceleration on maps whose fixed point is known.
#include "solver/anderson.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <limits>

namespace tissue_contact {
namespace anderson_test {

/// x -> A x + b in three dimensions.
struct LinearMap {
  Matrix3 A;
  Vector3 b = Vector3(1.0, 2.0, 3.0);

  LinearMap() { A << 0.5, 0.3, 0.0, 0.0, -0.7, 0.2, 0.1, 0.0, 0.9; }
  VectorX operator()(const VectorX& x) const { return A * x + b; }

  /// Least distance from the fixed point on the way.
  double leastError(AndersonMixing& mixing, int steps) const {
    const Vector3 answer = (Matrix3::Identity() - A).inverse() * b;
    VectorX x = Vector3::Zero();
    double least = std::numeric_limits<double>::infinity();
    for (int step = 0; step < steps; ++step) {
      x = mixing.next(x, (*this)(x));
      least = std::min(least, (x - answer).norm());
    }
    return least;
  }
};

TEST(AndersonMixing, SolvesALinearFixedPointInAsManyStepsAsDimensions) {
  AndersonMixing mixing(5);
  EXPECT_LE(LinearMap().leastError(mixing, 8), 1e-12);
}

TEST(AndersonMixing, OverwritesItsOldestStep) {
  AndersonMixing two(2);
  AndersonMixing one(1);
  const double with_two = LinearMap().leastError(two, 40);
  EXPECT_LE(with_two, 1e-6);  // the map alone: 0.9^40, 1e-2 of 26
  EXPECT_LT(with_two, LinearMap().leastError(one, 40));
}

TEST(AndersonMixing, StartsFromTheMapsOwnAnswerAfterTheResidualHasGrown) {
  AndersonMixing mixing(3);
  const auto at = [](double value) { return VectorX(VectorX::Constant(2, value)); };
  EXPECT_EQ(mixing.next(at(0.0), at(1.0)), at(1.0));
  EXPECT_NE(mixing.next(at(1.0), at(1.5)), at(1.5));  // two points of a line: extrapolated
  EXPECT_EQ(mixing.next(at(2.0), at(4.0)), at(4.0));
}

TEST(AndersonMixing, ForgetsAtARestartAndTakesAnotherSize) {
  AndersonMixing used(3);
  AndersonMixing fresh(3);
  LinearMap().leastError(used, 5);
  used.restart();
  for (const double x : {0.0, 1.0, 1.7}) {
    const VectorX from = VectorX::LinSpaced(7, x, 2.0);
    const VectorX g = VectorX::LinSpaced(7, 0.3 * x + 1.0, 1.0);
    EXPECT_EQ(used.next(from, g), fresh.next(from, g));
  }
}

}  // namespace anderson_test
}  // namespace tissue_contact
