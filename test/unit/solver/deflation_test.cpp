/// @file
/// Sweeps that go on along a way known from before, and stiff parts that move as one, against the textbook's product.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "body_sweep_fixture.h"

namespace tissue_contact {
namespace deflation_test {

/// The first sweep forth of a step whose contacts may move nodes 3 and 20, and move 3; then along u.
/// @return how deflation moves the nodes; zero at those.
NodalVectors deflated(const BodySystem& body, const NodalVectors& u, BodySweep& sweeps, NodalVectors& v) {
  sweeps.prepare(body);
  sweeps.sweep(true, {}, v, kHoldsNothing);
  sweeps.beginDeflation(u, {3, 20});
  const Vector3 moved(0.01, -0.02, 0.03);
  v.col(3) += moved;
  sweeps.follow(3, moved);
  const NodalVectors before = v;
  sweeps.deflate(v);
  NodalVectors way = v - before;
  EXPECT_EQ(Vector3(way.col(3)), Vector3::Zero());
  EXPECT_EQ(Vector3(way.col(20)), Vector3::Zero());
  return way;
}

/// way'(b - A v) by the textbook's product, J.
double workLeft(const BodySystem& body, const NodalVectors& way, const NodalVectors& v) {
  double work = 0.0;
  const auto product = [&](const BlockMatrix& matrix, int i) {
    return Vector3(matrix.diagonal[i] * v.col(i) + matrix.offDiagonalProduct(i, v));
  };
  for (int i = 0; i < body.K->rows(); ++i) {
    Vector3 defect = body.b.col(i) - body.mass[i] * v.col(i) - body.stiffness_scale * product(*body.K, i);
    if (body.D != nullptr) defect -= body.damping_scale * product(*body.D, i);
    work += way.col(i).dot(defect);
  }
  return work;
}

/// Along any u, of a body with fixed nodes; and the sweep back knows of it.
TEST(Deflation, GoesToWhereTheEnergyIsLeast) {
  for (const bool damped : {false, true}) {
    RandomBody body(30, 0.2, {0, 7}, {11, 12}, damped);
    BodySweep sweeps;
    NodalVectors v = NodalVectors::Zero(3, 30);
    const NodalVectors way = deflated(body.system, randomVectors(body), sweeps, v);
    for (const int node : {0, 7, 11, 12}) EXPECT_EQ(Vector3(way.col(node)), Vector3::Zero());
    ASSERT_GT(way.norm(),
              1e-4 * v.norm());  // far above round-off; how far it is hangs on the random numbers of the library
    // Round-off of sums of some hundred terms.
    EXPECT_LE(std::abs(workLeft(body.system, way, v)), 1e-13 * way.norm() * body.system.b.norm()) << damped;
    NodalVectors expected = v;
    plainSweep(body.system, NodalVectors::Zero(3, 30), false, std::vector<bool>(30, false), {}, expected);
    sweeps.sweep(false, {}, v, kHoldsNothing);
    EXPECT_LE((v - expected).norm(), 1e-14 * expected.norm()) << damped;
  }
}

/// In a later pair of sweeps of the step as well, among nodes that contacts hold.
TEST(Deflation, GoesOnThroughTheStep) {
  RandomBody body(30, 0.2, {0, 7}, {}, true);
  BodySweep sweeps;
  NodalVectors v = NodalVectors::Zero(3, 30);
  deflated(body.system, randomVectors(body), sweeps, v);
  sweeps.sweep(false, {}, v, kHoldsNothing);
  const Vector3 held_at(0.1, -0.2, 0.01);
  sweeps.sweep(true, {body.K.pattern->lane_of[20]}, v, [&](int node) {
    v.col(node) = held_at;
    return true;
  });
  const NodalVectors before = v;
  sweeps.deflate(v);
  NodalVectors way = v - before;
  EXPECT_EQ(Vector3(v.col(20)), held_at);
  ASSERT_GT(way.norm(), 0.0);
  EXPECT_LE(std::abs(workLeft(body.system, way, v)), 1e-13 * way.norm() * body.system.b.norm());
}

/// Nothing known, of another mesh, all nodes where contacts may move them, none that moves but by round-off, no number: all stay where they are.
TEST(Deflation, WithoutAWayMovesNothing) {
  RandomBody body(30, 0.2, {0, 7}, {}, false);
  std::vector<int> all(30);
  for (int i = 0; i < 30; ++i) all[static_cast<std::size_t>(i)] = i;
  const NodalVectors u = randomVectors(body);
  const auto moves = [&](const NodalVectors& along, const std::vector<int>& excluded) {
    BodySweep sweeps;
    NodalVectors v = NodalVectors::Zero(3, 30);
    sweeps.prepare(body.system);
    sweeps.sweep(true, {}, v, kHoldsNothing);
    sweeps.beginDeflation(along, excluded);
    const NodalVectors before = v;
    sweeps.deflate(v);
    return v != before;
  };
  EXPECT_TRUE(moves(u, {}));
  EXPECT_FALSE(moves(u, all));
  EXPECT_FALSE(moves(NodalVectors(3, 0), {}));
  EXPECT_FALSE(moves(u.leftCols(29), {}));
  EXPECT_FALSE(moves(0.0 * u, {}));
  EXPECT_TRUE(moves(1e-6 * u, {}));
  EXPECT_FALSE(moves(1e-10 * u, {}));  // round-off
  EXPECT_FALSE(moves(std::nan("") * u, {}));
}

/// Where K takes nearly all from the energy that mass has, its least is nowhere to go to.
TEST(Deflation, LeavesWhatHasNextToNoEnergy) {
  for (const double left : {0.9, 0.1}) {
    RandomBody body(30, 0.2, {}, {}, false);
    for (BlockLanes& entry : body.K.values) {
      for (auto& lanes : entry.at) {
        for (double& value : lanes) value *= 1e-3;
      }
    }
    for (int i = 0; i < 30; ++i) {
      body.K.diagonal[static_cast<std::size_t>(i)] =
          -(1.0 - left) * body.system.mass[i] / body.system.stiffness_scale * Matrix3::Identity();
    }
    BodySweep sweeps;
    NodalVectors v = NodalVectors::Zero(3, 30);
    sweeps.prepare(body.system);
    sweeps.sweep(true, {}, v, kHoldsNothing);
    sweeps.beginDeflation(randomVectors(body), {});
    const NodalVectors before = v;
    sweeps.deflate(v);
    EXPECT_EQ(v != before, left > 0.5) << left;
  }
}

/// Two parts that move as one, with nodes 0, 7, 11 and 12 of the body fixed; contacts may move nodes 3 and 20, and move 3.
class StiffParts : public ::testing::TestWithParam<bool> {
 protected:
  StiffParts() : body_(30, 0.2, {0, 7}, {11, 12}, GetParam()), x_(0.01 * randomVectors(body_)) {
    body_.system.stiff_parts = &parts_;
    body_.system.x = &x_;
  }

  /// A sweep forth, and what contacts move then. @return how the parts, and v along u, move the nodes.
  NodalVectors moved(const NodalVectors& u, BodySweep& sweeps, NodalVectors& v) {
    sweeps.prepare(body_.system);
    sweeps.sweep(true, {}, v, kHoldsNothing);
    sweeps.beginDeflation(u, {3, 20});
    sweeps.beginRigidMotions({3, 20});
    const Vector3 by(0.01, -0.02, 0.03);
    v.col(3) += by;
    sweeps.follow(3, by);
    const NodalVectors before = v;
    sweeps.deflate(v);
    return v - before;
  }

  /// A shift or a turn of what is free of a part, 3 x nodes.
  NodalVectors motion(const std::vector<int>& part, int k) const {
    NodalVectors way = NodalVectors::Zero(3, 30);
    for (const int node : part) {
      if (node == 3 || node == 12) continue;
      way.col(node) = k < 3 ? Vector3(Vector3::Unit(k)) : Vector3(Vector3::Unit(k - 3).cross(x_.col(node)));
    }
    return way;
  }

  std::vector<std::vector<int>> parts_ = {{3, 4, 9, 15, 16, 22}, {1, 2, 12, 21, 25, 26, 27}};
  std::vector<std::vector<int>> only_;
  RandomBody body_;
  NodalVectors x_;
};

INSTANTIATE_TEST_SUITE_P(Damped, StiffParts, ::testing::Bool());

TEST_P(StiffParts, MoveToWhereTheEnergyIsLeast) {
  for (const std::size_t alone : {0, 1}) {
    const std::vector<int> part = parts_[alone];
    body_.system.stiff_parts = &only_;
    only_ = {part};
    BodySweep sweeps;
    NodalVectors v = NodalVectors::Zero(3, 30);
    const NodalVectors way = moved(NodalVectors(3, 0), sweeps, v);
    ASSERT_GT(way.norm(), 1e-3 * v.norm());
    for (int i = 0; i < 30; ++i) {
      const bool is_of_it = std::count(part.begin(), part.end(), i) > 0 && i != 3 && i != 12;
      EXPECT_EQ(!way.col(i).isZero(0.0), is_of_it) << i;
    }
    for (int k = 0; k < 6; ++k) {
      const NodalVectors along = motion(part, k);
      // Round-off of sums of some hundred terms.
      EXPECT_LE(std::abs(workLeft(body_.system, along, v)), 1e-13 * along.norm() * body_.system.b.norm()) << k;
    }
  }
}

/// Of two parts that blocks join, and v along u, the later ones know where the earlier have gone; so does the sweep back.
TEST_P(StiffParts, KnowOfEachOtherAndAreKnownOf) {
  BodySweep sweeps;
  NodalVectors v = NodalVectors::Zero(3, 30);
  moved(NodalVectors(3, 0), sweeps, v);
  for (int k = 0; k < 6; ++k) {
    const NodalVectors along = motion(parts_[1], k);
    EXPECT_LE(std::abs(workLeft(body_.system, along, v)), 1e-13 * along.norm() * body_.system.b.norm()) << k;
  }
  NodalVectors u = randomVectors(body_);
  v.setZero();
  moved(u, sweeps, v);
  for (const int node : {0, 3, 7, 11, 12, 20}) u.col(node).setZero();
  EXPECT_LE(std::abs(workLeft(body_.system, u, v)), 1e-13 * u.norm() * body_.system.b.norm());
  NodalVectors expected = v;
  plainSweep(body_.system, NodalVectors::Zero(3, 30), false, std::vector<bool>(30, false), {}, expected);
  sweeps.sweep(false, {}, v, kHoldsNothing);
  EXPECT_LE((v - expected).norm(), 1e-14 * expected.norm());
  // And in the next pair of sweeps, from where that one has led.
  sweeps.sweep(true, {}, v, kHoldsNothing);
  sweeps.deflate(v);
  EXPECT_LE(std::abs(workLeft(body_.system, u, v)), 1e-13 * u.norm() * body_.system.b.norm());
}

/// The next step knows of none, of a smaller body.
TEST_P(StiffParts, AreForgottenInTheNextStep) {
  BodySweep sweeps;
  NodalVectors v = NodalVectors::Zero(3, 30);
  ASSERT_FALSE(moved(NodalVectors(3, 0), sweeps, v).isZero(0.0));
  RandomBody smaller(10, 0.3, {1}, {4}, GetParam());
  sweeps.prepare(smaller.system);
  v = NodalVectors::Zero(3, 10);
  sweeps.sweep(true, {}, v, kHoldsNothing);
  sweeps.follow(2, Vector3(0.01, -0.02, 0.03));
  const NodalVectors before = v;
  sweeps.deflate(v);
  EXPECT_EQ(v, before);
}

/// Where K takes nearly all from the energy that mass has.
TEST_P(StiffParts, WithNextToNoEnergyStay) {
  body_.system.stiff_parts = &only_;
  only_ = {{4, 9, 15, 16, 22}};
  for (const double left : {0.9, 0.1}) {
    body_.D.setZero();
    for (BlockLanes& entry : body_.K.values) {
      for (auto& lanes : entry.at) {
        for (double& value : lanes) value *= 1e-2;
      }
    }
    for (int i = 0; i < 30; ++i) {
      body_.K.diagonal[static_cast<std::size_t>(i)] =
          -(1.0 - left) * body_.system.mass[i] / body_.system.stiffness_scale * Matrix3::Identity();
    }
    BodySweep sweeps;
    NodalVectors v = NodalVectors::Zero(3, 30);
    EXPECT_EQ(!moved(NodalVectors(3, 0), sweeps, v).isZero(0.0), left > 0.5) << left;
  }
}

/// All fixed, in a line, all in one place, or none of them free of contacts: such parts have no motions.
TEST_P(StiffParts, WithoutMotionsOfTheirOwnStay) {
  body_.system.stiff_parts = &only_;
  const auto moves = [&](const std::vector<int>& part) {
    only_ = {part};
    BodySweep sweeps;
    NodalVectors v = NodalVectors::Zero(3, 30);
    return !moved(NodalVectors(3, 0), sweeps, v).isZero(0.0);
  };
  EXPECT_TRUE(moves({1, 2, 4, 5}));
  EXPECT_FALSE(moves({0, 7, 11, 12}));
  EXPECT_FALSE(moves({3, 20}));
  EXPECT_FALSE(moves({}));
  EXPECT_FALSE(moves({5}));
  const Vector3 from(0.1, 0.2, 0.3);
  for (const int node : {1, 2, 4, 5}) x_.col(node) = from + node * Vector3(1e-3, 2e-3, -1e-3);
  EXPECT_FALSE(moves({1, 2, 4, 5}));
  for (const int node : {1, 2, 4, 5}) x_.col(node) = from;
  EXPECT_FALSE(moves({1, 2, 4, 5}));
}

}  // namespace deflation_test
}  // namespace tissue_contact
