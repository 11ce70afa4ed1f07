/// Sweeps four rows at a time, against the same node by node and block by block.
#include "solver/body_sweep.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <functional>
#include <random>
#include <vector>

namespace tissue_contact {
namespace body_sweep_test {

/// A body with blocks of no symmetry of their own in K and in D, which is no multiple of K.
struct RandomBody {
  std::vector<bool> fixed;
  BlockMatrix K, D;
  BodySystem system;

  /// @param pattern_fixed nodes without blocks; `held_still` are fixed too, but have blocks.
  RandomBody(int nodes, double joined, const std::vector<int>& pattern_fixed, const std::vector<int>& held_still,
             bool damped) {
    std::vector<std::array<int, 2>> pairs;
    for (int i = 0; i < nodes; ++i) {
      for (int j = 0; j < i; ++j) {
        if (uniform_(random_) < joined) pairs.push_back({i, j});
      }
    }
    fixed.assign(static_cast<std::size_t>(nodes), false);
    for (const int i : pattern_fixed) fixed[i] = true;
    K = BlockMatrix::forElements(pairs, fixed);
    D = BlockMatrix(K.pattern);
    fill(K, 8.0 + nodes);
    fill(D, 5.0);
    for (const int i : held_still) fixed[i] = true;
    system.K = &K;
    system.D = damped ? &D : nullptr;
    system.fixed = &fixed;
    system.stiffness_scale = 0.7;
    system.damping_scale = 0.2;
    system.mass.resize(nodes);
    system.b.resize(3, nodes);
    for (int i = 0; i < nodes; ++i) {
      system.mass[i] = 1.0 + uniform_(random_);
      system.b.col(i) = fixed[i] ? Vector3(Vector3::Zero()) : randomVector();
    }
  }
  RandomBody(const RandomBody&) = delete;
  RandomBody& operator=(const RandomBody&) = delete;

  Vector3 randomVector() { return {uniform_(random_) - 0.5, uniform_(random_) - 0.5, uniform_(random_) - 0.5}; }
  bool chance(double of) { return uniform_(random_) < of; }

 private:
  void fill(BlockMatrix& matrix, double diagonal) {
    for (int i = 0; i < matrix.rows(); ++i) {
      if (fixed[i]) continue;
      Matrix3 own;
      own << randomVector(), randomVector(), randomVector();
      matrix.diagonal[i] = diagonal * Matrix3::Identity() + own + own.transpose();
      matrix.pattern->forRow(i, [&](int j, int place) {
        if (j < i) return;
        Matrix3 block;
        block << randomVector(), randomVector(), randomVector();
        matrix.add(place, block);
      });
    }
  }

  std::mt19937 random_{5};
  std::uniform_real_distribution<double> uniform_{0.0, 1.0};
};

/// What a contact makes of a node that it may hold: true, it holds it.
using Hold = std::function<bool(int node, Vector3& v)>;

/// The textbook's sweep. @return the defects met at nodes that nothing holds.
DefectsMet plainSweep(const BodySystem& body, const NodalVectors& impulses, bool forward,
                      const std::vector<bool>& may_hold, const Hold& hold, NodalVectors& v) {
  const int nodes = body.K->rows();
  DefectsMet met;
  for (int step = 0; step < nodes; ++step) {
    const int i = forward ? step : nodes - 1 - step;
    if ((*body.fixed)[i]) continue;
    Vector3 defect = body.b.col(i) + impulses.col(i) - body.mass[i] * v.col(i);
    Matrix3 block = body.mass[i] * Matrix3::Identity();
    const auto take = [&](const BlockMatrix& matrix, double scale) {
      defect -= scale * (matrix.diagonal[i] * v.col(i));
      matrix.pattern->forRow(i, [&](int j, int place) { defect -= scale * (matrix.block(place) * v.col(j)); });
      block += scale * matrix.diagonal[i];
    };
    take(*body.K, body.stiffness_scale);
    if (body.D != nullptr) take(*body.D, body.damping_scale);
    v.col(i) += block.inverse() * defect;
    Vector3 moved = v.col(i);
    const bool held = may_hold[i] && hold(i, moved);
    v.col(i) = moved;
    if (!held) met += {defect.squaredNorm(), defect};
  }
  return met;
}

/// Some sweeps forth and back, with impulses and with nodes that contacts hold, against the textbook's.
void compareSweeps(RandomBody& body, double held_share) {
  const int nodes = body.K.rows();
  std::vector<bool> may_hold(static_cast<std::size_t>(nodes), false);
  std::vector<int> held;
  NodalVectors impulses = NodalVectors::Zero(3, nodes);
  BodySweep sweeps;
  sweeps.prepare(body.system);
  for (int i = 0; i < nodes; ++i) {
    if (body.fixed[i]) continue;
    impulses.col(i) = body.randomVector();
    sweeps.addImpulse(i, impulses.col(i));
    may_hold[i] = body.chance(held_share);
    if (may_hold[i]) held.push_back(body.K.pattern->lane_of[i]);
  }
  std::sort(held.begin(), held.end());
  const Hold hold = [](int node, Vector3& v) {
    if (node % 3 == 0) return false;  // its contact lets go
    v = Vector3(0.1, -0.2, 0.01 * node);
    return true;
  };
  NodalVectors v = NodalVectors::Zero(3, nodes);
  NodalVectors expected = v;
  for (int sweep = 0; sweep < 4; ++sweep) {
    const bool forward = sweep % 2 == 0;
    const DefectsMet expected_met = plainSweep(body.system, impulses, forward, may_hold, hold, expected);
    const DefectsMet met = sweeps.sweep(forward, held, v, [&](int node) {
      Vector3 moved = v.col(node);
      const bool holds = hold(node, moved);
      v.col(node) = moved;
      return holds;
    });
    // Sums of some ten terms in another order.
    EXPECT_LE((v - expected).norm(), 1e-14 * expected.norm()) << nodes << " nodes, sweep " << sweep;
    // A defect is the difference of the loads and of A v; the blocks of A's diagonal are below 10 + nodes.
    const double terms = (body.system.b + impulses).norm() + (10.0 + nodes) * expected.norm();
    EXPECT_NEAR(std::sqrt(met.squared), std::sqrt(expected_met.squared), 1e-14 * terms)
        << nodes << " nodes, sweep " << sweep;
    EXPECT_LE((met.sum - expected_met.sum).norm(), 1e-14 * terms) << nodes << " nodes, sweep " << sweep;
    for (int i = 0; i < nodes; ++i) {
      if (!body.fixed[i]) continue;
      EXPECT_EQ(Vector3(v.col(i)), Vector3::Zero());
    }
  }
}

TEST(BodySweep, IsTheSweepNodeByNode) {
  for (const bool damped : {false, true}) {
    for (const int nodes : {1, 2, 3, 4, 5, 7, 30, 61}) {  // slices that have fewer than four rows among them
      for (const double held_share : {0.0, 0.3, 1.0}) {
        RandomBody body(nodes, 0.2, {}, {}, damped);
        compareSweeps(body, held_share);
      }
    }
  }
}

/// Fixed nodes without blocks, such as those of a boundary, and with blocks, such as those asleep; slices of nothing else.
TEST(BodySweep, LeavesFixedNodesWhereTheyAre) {
  for (const bool damped : {false, true}) {
    RandomBody some(30, 0.2, {0, 7, 8, 29}, {3, 4, 5, 20}, damped);
    compareSweeps(some, 0.3);
    RandomBody most(13, 0.5, {0, 1, 2, 3, 4}, {5, 6, 7, 8, 9, 10, 12}, damped);
    compareSweeps(most, 1.0);
    RandomBody all(6, 0.5, {0, 1, 2}, {3, 4, 5}, damped);
    compareSweeps(all, 1.0);
  }
}

/// Of blocks that all touch each other no two lie in one slice.
TEST(BodySweep, TakesRowsOneByOneWhereAllAreNeighbours) {
  RandomBody body(9, 1.1, {}, {}, true);
  EXPECT_EQ(body.K.pattern->slices(), 9);
  compareSweeps(body, 0.3);
}

TEST(BodySweep, InverseIsThatOfTheDiagonalBlock) {
  for (const bool damped : {false, true}) {
    RandomBody body(11, 0.3, {2}, {6}, damped);
    BodySweep sweeps;
    sweeps.prepare(body.system);
    for (int i = 0; i < 11; ++i) {
      Matrix3 block = body.system.mass[i] * Matrix3::Identity() + body.system.stiffness_scale * body.K.diagonal[i];
      if (damped) block += body.system.damping_scale * body.D.diagonal[i];
      const Matrix3 expected = body.fixed[i] ? Matrix3(Matrix3::Zero()) : Matrix3(block.inverse());
      EXPECT_LE((sweeps.inverse(i) - expected).norm(), 1e-15 * expected.norm()) << "node " << i;
    }
  }
}

/// A body after a larger one, with nodes fixed that were free: nothing of it is left.
TEST(BodySweep, BeginsAnew) {
  RandomBody larger(40, 0.2, {}, {}, true);
  RandomBody body(10, 0.3, {1}, {4}, false);
  BodySweep used, fresh;
  used.prepare(larger.system);
  NodalVectors v = NodalVectors::Zero(3, 40);
  used.addImpulse(4, Vector3(1.0, 2.0, 3.0));
  used.sweep(true, {}, v, [](int /*node*/) { return false; });
  NodalVectors of_used = NodalVectors::Zero(3, 10), of_fresh = NodalVectors::Zero(3, 10);
  used.prepare(body.system);
  fresh.prepare(body.system);
  for (const bool forward : {true, false}) {
    used.sweep(forward, {}, of_used, [](int /*node*/) { return false; });
    fresh.sweep(forward, {}, of_fresh, [](int /*node*/) { return false; });
    EXPECT_EQ(of_used, of_fresh);
  }
}

const auto kHoldsNothing = [](int /*node*/) { return false; };

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

NodalVectors randomVectors(RandomBody& body) {
  NodalVectors u = NodalVectors::Zero(3, body.K.rows());
  for (int i = 0; i < body.K.rows(); ++i) u.col(i) = body.randomVector();
  return u;
}

/// Along any u, of a body with fixed nodes; and the sweep back knows of it.
TEST(BodySweep, DeflationGoesToWhereTheEnergyIsLeast) {
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
TEST(BodySweep, DeflationGoesOnThroughTheStep) {
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
TEST(BodySweep, WithoutAWayDeflationMovesNothing) {
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
TEST(BodySweep, DeflationLeavesWhatHasNextToNoEnergy) {
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

/// What sweeps found after the first one forth, with what moved between; where that is all, what was known stays.
TEST(BodySweep, WhatIsKeptIsWhatTheFirstSweepForthDidNotFind) {
  RandomBody body(30, 0.2, {0, 7}, {}, false);
  BodySweep sweeps;
  NodalVectors v = NodalVectors::Zero(3, 30);
  const NodalVectors u = randomVectors(body);
  NodalVectors kept = u;
  sweeps.prepare(body.system);
  sweeps.sweep(true, {}, v, kHoldsNothing);
  const NodalVectors first = v;
  sweeps.deflate(v);
  sweeps.finish(true, v, kept);
  EXPECT_EQ(kept, u);
  sweeps.sweep(false, {}, v, kHoldsNothing);
  sweeps.sweep(true, {}, v, kHoldsNothing);
  sweeps.finish(true, v, kept);
  EXPECT_EQ(kept, NodalVectors(v - first));
  const NodalVectors second = v;
  sweeps.deflate(v);
  sweeps.sweep(false, {}, v, kHoldsNothing);
  sweeps.finish(false, v, kept);
  EXPECT_EQ(kept, NodalVectors(second - first));
}

}  // namespace body_sweep_test
}  // namespace tissue_contact
