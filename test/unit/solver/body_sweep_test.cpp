/// Sweeps four rows at a time, against the same node by node and block by block.
#include "solver/body_sweep.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "body_sweep_fixture.h"

namespace tissue_contact {
namespace body_sweep_test {

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
