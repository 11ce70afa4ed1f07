/// A coarse level of rigid motions for the sweeps: what it finds at once, that its correction is the best it has, and what it is for.
#include "solver/coarse_motions.h"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <limits>
#include <memory>
#include <random>
#include <vector>

#include "solver/body_sweep.h"
#include "solver/convergence_forecast.h"
#include "solver/iterative_predictor_corrector.h"
#include "solver/momentum_defect.h"
#include "support/pressed_block.h"

namespace tissue_contact {
namespace coarse_motions_test {

/// A bar of 80 x 8 x 8 mm along x, 20 x 2 x 2 cells, held at its left end or loose; D is no multiple of K.
struct Bar {
  TetMesh mesh = makeBlockMesh({Vector3(0.08, 0.008, 0.008), {20, 2, 2}, {}});
  std::vector<bool> fixed;
  std::unique_ptr<Elasticity::State> state, viscous;
  ContactProblem problem;
  ContactSolution solution;

  explicit Bar(bool held, bool damped = false, double dt = 0.02) {
    for (auto i = 0; i < mesh.positions.cols(); ++i) fixed.push_back(held && mesh.positions(0, i) < 1e-6);
    const auto stiffnessOf = [&](double nu) {
      const MaterialDescription material{ElasticModel::kLinear, 5e3, nu, 1000.0};
      return TetElasticity(mesh.positions, mesh.tetrahedra, fixed, material).makeState();
    };
    state = stiffnessOf(0.45);
    viscous = stiffnessOf(0.2);
    BodySystem body;
    body.K = &state->stiffness;
    body.D = damped ? &viscous->stiffness : nullptr;
    body.fixed = &fixed;
    body.x = &mesh.positions;
    body.stiffness_scale = dt * dt;
    body.damping_scale = damped ? 0.003 * dt : 0.0;
    body.mass = VectorX::Constant(nodes(), 1000.0 * 0.08 * 0.008 * 0.008 / static_cast<double>(nodes()));
    body.b = NodalVectors::Zero(3, nodes());
    problem.dt_s = dt;
    problem.bodies = {body};
    solution.v = {body.b};
  }

  Eigen::Index nodes() const { return mesh.positions.cols(); }
  const BodySystem& body() const { return problem.bodies[0]; }
  /// r - A v, padded; 0 at fixed nodes.
  PaddedVectors defect(const NodalVectors& r, const NodalVectors& v) const {
    BodySystem loaded = body();
    loaded.b.setZero();
    NodalVectors left(3, nodes());
    bodyDefect(loaded, v, r, left);
    PaddedVectors padded;
    pad(left, padded);
    return padded;
  }
  NodalVectors randomVectors() const {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> uniform(-1.0, 1.0);
    NodalVectors result(3, nodes());
    for (Eigen::Index i = 0; i < nodes(); ++i)
      result.col(i) = Vector3(uniform(random), uniform(random), uniform(random));
    for (std::size_t i = 0; i < fixed.size(); ++i) {
      if (fixed[i]) result.col(static_cast<Eigen::Index>(i)).setZero();
    }
    return result;
  }
};

NodalVectors along(CoarseMotions& coarse, const PaddedVectors& defect) {
  PaddedVectors padded(defect.size());
  coarse.direction(defect, padded);
  NodalVectors result(3, static_cast<Eigen::Index>(defect.size()));
  unpad(padded, result);
  return result;
}

// Parts that all move alike are the body moving as one, since their weights sum up to one at each node.
TEST(CoarseMotions, FindTheRigidMotionOfALooseBodyAtOnce) {
  for (const bool damped : {false, true}) {
    const Bar bar(false, damped);
    NodalVectors v(3, bar.nodes());
    for (Eigen::Index i = 0; i < bar.nodes(); ++i) {
      v.col(i) = Vector3(0.1, -0.2, 0.3) + Vector3(1.0, 2.0, -3.0).cross(Vector3(bar.mesh.positions.col(i)));
    }
    PaddedVectors defect = bar.defect(NodalVectors::Zero(3, bar.nodes()), -v);  // A v
    CoarseMotions coarse;
    coarse.begin(bar.body(), {});
    ASSERT_TRUE(coarse.any());
    EXPECT_LE((along(coarse, defect) - v).norm(), 1e-6 * v.norm())
        << damped;  // K's soft motions are round-off beside its stiff ones
  }
}

/// What the motions make of a random defect. By Galerkin's condition nothing is left then that any of them could take off.
NodalVectors correctionThatLeavesNothing(const Bar& bar, const std::vector<int>& excluded) {
  CoarseMotions coarse;
  coarse.begin(bar.body(), excluded);
  EXPECT_TRUE(coarse.any());
  const NodalVectors r = bar.randomVectors();
  const NodalVectors found = along(coarse, bar.defect(r, NodalVectors::Zero(3, bar.nodes())));
  EXPECT_GT(found.norm(), 0.0);
  EXPECT_LE(along(coarse, bar.defect(r, found)).norm(), 1e-6 * found.norm());
  return found;
}

// Through D, fixed nodes and nodes of contacts.
TEST(CoarseMotions, LeaveNothingOfADefectThatTheyCouldTakeOff) {
  const Bar bar(true, true);
  const std::vector<int> excluded = {100, 101, 150};
  const NodalVectors found = correctionThatLeavesNothing(bar, excluded);
  for (const int node : excluded) EXPECT_EQ(found.col(node).norm(), 0.0);
  for (std::size_t i = 0; i < bar.fixed.size(); ++i) {
    if (bar.fixed[i]) {
      EXPECT_EQ(found.col(static_cast<Eigen::Index>(i)).norm(), 0.0);
    }
  }
}

TEST(CoarseMotions, ThereAreNoneWithoutPlacesOrOfFewNodes) {
  Bar bar(true);
  CoarseMotions coarse;
  coarse.begin(bar.body(), {});
  EXPECT_TRUE(coarse.any());
  std::vector<int> all_but_some;
  for (int i = 15; i < bar.nodes(); ++i) all_but_some.push_back(i);
  coarse.begin(bar.body(), all_but_some);
  EXPECT_FALSE(coarse.any());
  coarse.begin(bar.body(), {});
  EXPECT_TRUE(coarse.any());
  bar.problem.bodies[0].x = nullptr;
  coarse.begin(bar.body(), {});
  EXPECT_FALSE(coarse.any());
}

// Of nodes in a line, which turn about it for nothing, and of parts with one node or none.
TEST(CoarseMotions, OfNodesInALineAreThoseThatMoveThem) {
  const Bar bar(false);
  std::vector<int> excluded;
  for (int i = 0; i < bar.nodes(); ++i) {
    if (bar.mesh.positions.col(i).tail<2>().norm() > 1e-6) excluded.push_back(i);
  }
  ASSERT_EQ(static_cast<std::size_t>(bar.nodes()) - excluded.size(), 21u);
  correctionThatLeavesNothing(bar, excluded);
}

// Parts hang on the mesh alone: what another body, fixed otherwise, left behind changes no bit.
TEST(CoarseMotions, ForgetTheBodyBefore) {
  const Bar bar(true, true), loose(false);
  const PressedBlock small(0.5, 0.01);
  BodySystem block = small.problem.bodies[0];
  block.x = &small.mesh.positions;
  const PaddedVectors defect = bar.defect(bar.randomVectors(), NodalVectors::Zero(3, bar.nodes()));
  const std::vector<int> excluded = {30, 90};
  CoarseMotions fresh, used;
  fresh.begin(bar.body(), excluded);
  const NodalVectors found = along(fresh, defect);
  used.begin(loose.body(), {5});
  used.begin(block, {});
  used.begin(bar.body(), excluded);
  EXPECT_EQ(along(used, defect), found);
}

// A body in two pieces, and one in more pieces than there are parts: those without one stay where they are.
TEST(CoarseMotions, OfPiecesThatNothingJoins) {
  for (const int pieces : {2, 30}) {
    std::vector<std::array<int, 2>> pairs;
    const int nodes = 40 * pieces;
    for (int i = 0; i < nodes; ++i) {
      if (i % 40 != 39) pairs.push_back({i, i + 1});
    }
    const std::vector<bool> fixed(static_cast<std::size_t>(nodes), false);
    BlockMatrix K = BlockMatrix::forElements(pairs, fixed);
    NodalVectors x(3, nodes);
    for (int i = 0; i < nodes; ++i) {
      K.diagonal[static_cast<std::size_t>(i)] = 2.0 * Matrix3::Identity();
      x.col(i) = Vector3(i % 40, i, (i * i) % 5);
    }
    BodySystem body;
    body.K = &K;
    body.fixed = &fixed;
    body.x = &x;
    body.stiffness_scale = 1.0;
    body.mass = VectorX::Ones(nodes);
    CoarseMotions coarse;
    coarse.begin(body, {});
    ASSERT_TRUE(coarse.any());
    PaddedVectors defect(static_cast<std::size_t>(nodes));
    for (PaddedVector& at : defect) at = {{3.0, 0.0, 0.0, 0.0}};  // A is three times one: all of v is (1, 0, 0)
    const NodalVectors found = along(coarse, defect);
    EXPECT_TRUE(found.array().isFinite().all());
    int moved = 0;
    for (int i = 0; i < nodes; ++i) {
      const double off = (found.col(i) - Vector3::UnitX()).norm();
      if (off > 1e-6) {
        EXPECT_EQ(found.col(i).norm(), 0.0) << i;
      }
      moved += off <= 1e-6 ? 1 : 0;
    }
    EXPECT_EQ(moved, pieces == 2 ? nodes : 40 * 16);
  }
}

// Between a sweep forth and the sweep back, nodes that contacts have moved followed: nothing is left along the motions, and the sweep back goes by the
// sums of earlier nodes as they are then.
TEST(CoarseMotions, ASweepBackKnowsWhatTheyMoved) {
  for (const bool damped : {false, true}) {
    Bar bar(true, damped);
    bar.problem.bodies[0].b = 1e-6 * bar.randomVectors();
    const std::vector<int> touched = {100, 101};
    BodySweep sweep;
    sweep.prepare(bar.body());
    NodalVectors v = NodalVectors::Zero(3, bar.nodes());
    const auto hold = [](int) { return false; };
    sweep.sweep(true, {}, v, hold);
    sweep.beginDeflation(bar.randomVectors(), touched);
    sweep.beginCoarseMotions(touched);
    for (const int node : touched) {
      const Vector3 change(1e-3, 2e-3, -1e-3);
      v.col(node) += change;
      sweep.follow(node, change);
    }
    sweep.deflate(v);
    CoarseMotions coarse;
    coarse.begin(bar.body(), touched);
    EXPECT_LE(along(coarse, bar.defect(bar.body().b, v)).norm(), 1e-6 * v.norm());
    NodalVectors expected = v;
    for (int i = static_cast<int>(bar.nodes()) - 1; i >= 0; --i) {
      if (bar.fixed[static_cast<std::size_t>(i)]) continue;
      const PaddedVectors left = bar.defect(bar.body().b, expected);
      expected.col(i) += sweep.inverse(i) * vectorOf(left[static_cast<std::size_t>(i)]);
    }
    sweep.sweep(false, {}, v, hold);
    EXPECT_LE((v - expected).norm(), 1e-9 * expected.norm());
  }
}

/// Iterations until a bar that a load bends is solved, and its answer.
int iterationsOfBending(bool coarsely, Bar& bar) {
  for (Eigen::Index i = 0; i < bar.nodes(); ++i) {
    if (!bar.fixed[static_cast<std::size_t>(i)]) bar.problem.bodies[0].b(2, i) = -1e-6;
  }
  if (!coarsely) bar.problem.bodies[0].x = nullptr;
  const SolverReport report = IterativePredictorCorrector(options(3000, 2, 1e-9)).solve(bar.problem, bar.solution);
  EXPECT_EQ(report.stop, StopReason::kTolerance);
  return report.iterations;
}

TEST(CoarseMotions, BendASlenderBodySoonerToTheSameAnswer) {
  for (const bool damped : {false, true}) {
    Bar plain(true, damped), coarse(true, damped);
    const int without = iterationsOfBending(false, plain);
    const int with = iterationsOfBending(true, coarse);
    EXPECT_LT(with, 0.4 * without) << with << " of " << without;
    EXPECT_LE((coarse.solution.v[0] - plain.solution.v[0]).norm(), 1e-6 * plain.solution.v[0].norm());
  }
}

// A step of more iterations than a forecast takes, which foresees few, is the same to the bit with and without.
TEST(CoarseMotions, AreNotLookedForInEasySteps) {
  const auto solved = [](bool may) {
    Bar bar(true, false, 0.0005);
    bar.problem.bodies[0].b = 1e-6 * bar.randomVectors();
    if (!may) bar.problem.bodies[0].x = nullptr;
    const SolverReport report = IterativePredictorCorrector(options(100, 2, 1e-9)).solve(bar.problem, bar.solution);
    EXPECT_EQ(report.stop, StopReason::kTolerance);
    EXPECT_GT(report.iterations, 12);
    return bar.solution.v[0];
  };
  EXPECT_EQ(solved(true), solved(false));
}

TEST(ConvergenceForecast, GoesOnAtTheRateOfTheLastIterations) {
  ConvergenceForecast forecast;
  forecast.begin();
  double excess = 1e4;
  for (int k = 1; k <= 12; ++k) {
    excess *= k % 2 == 0 ? 0.5 : 0.98;  // sweeps forth and back leave different defects
    forecast.add(excess);
    if (k < 8) {
      EXPECT_EQ(forecast.iterationsLeft(), 0.0);
    }
  }
  EXPECT_NEAR(forecast.iterationsLeft(), 2.0 * std::log(excess) / -std::log(0.5 * 0.98), 1e-9);
}

TEST(ConvergenceForecast, KnowsWhatIsDoneAndWhatNeverEnds) {
  ConvergenceForecast forecast;
  for (int k = 0; k < 9; ++k) forecast.add(2.0);
  EXPECT_EQ(forecast.iterationsLeft(), std::numeric_limits<double>::infinity());
  forecast.add(1.0);
  EXPECT_EQ(forecast.iterationsLeft(), 0.0);
  forecast.add(std::numeric_limits<double>::quiet_NaN());
  EXPECT_EQ(forecast.iterationsLeft(), 0.0);
  forecast.begin();
  forecast.add(2.0);
  EXPECT_EQ(forecast.iterationsLeft(), 0.0);
  for (int k = 0; k < 4; ++k) forecast.add(0.0);  // no load at first
  for (int k = 0; k < 4; ++k) forecast.add(2.0);
  EXPECT_EQ(forecast.iterationsLeft(), 0.0);
}

}  // namespace coarse_motions_test
}  // namespace tissue_contact
