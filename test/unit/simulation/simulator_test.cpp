/// The simulator on bad input and on motions that break simulators: fast entry, start inside, jumps.
#include "tissue_contact/simulation/simulator.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>

#include "simulation/instrument_motion.h"
#include "support/refusal.h"
#include "support/text_scene.h"

namespace tissue_contact {
namespace simulator_test {

/// A 5 mm sphere over a block of 60 x 60 x 20 mm, 1 mm above its middle at joints 0.
Simulator makeScene(double max_step_s = 0.001, double height_m = 0.026, const std::string& poissons_ratio = "0.45") {
  std::ostringstream rest;
  rest << onlyBall("[0.001, 0.002, " + std::to_string(height_m) + "]") << "step: {max_step_s: " << max_step_s << "}\n"
       << "friction:\n  - {instrument: probe, tissue: block, static: 0.5, kinetic: 0.4}\n";
  const std::string material = "model: corotational, poissons_ratio: " + poissons_ratio;
  return makeSimulator(blockScene("[0.06, 0.06, 0.02]", "[6, 6, 2]", material) + rest.str(),
                       {{"probe", probeUrdf(0.005)}});
}

/// Deepest point of the tissue surface inside the sphere, m.
double penetration(const Simulator& simulator) {
  const Vector3 center = simulator.linkPoses(0).back().translation();
  double deepest = 0.0;
  for (Eigen::Index i = 0; i < simulator.positions(0).cols(); ++i) {
    deepest = std::max(deepest, 0.005 - (simulator.positions(0).col(i) - center).norm());
  }
  return deepest;
}

TEST(Simulator, LimitsThatDoNotBiteChangeNoBit) {
  Simulator plain = makeScene();
  Simulator limited = makeScene();
  int asked = 0;
  const AdvanceLimits limits{1000, [&] { return ++asked < 0; }};
  plain.advance(0.05, {Vector3(0.001, 0.0, -0.004)});
  limited.advance(0.05, {Vector3(0.001, 0.0, -0.004)}, limits);
  EXPECT_EQ(asked, 49);  // between steps, so not after the last
  EXPECT_EQ(limited.report().substeps, 50);
  EXPECT_EQ(limited.report().advanced_s, 0.05);
  EXPECT_EQ(limited.positions(0), plain.positions(0));
  EXPECT_EQ(limited.wrench(0).force, plain.wrench(0).force);
}

TEST(Simulator, TakesLongerStepsWhereAllowedButNotBeyondItsTravel) {
  AdvanceLimits limits;
  limits.longest_step_s = 0.00125;
  Simulator simulator = makeScene();
  simulator.advance(0.0011, {Vector3(0.0, 0.0, -0.001)}, limits);
  EXPECT_EQ(simulator.stepCount(), 1);
  simulator.advance(0.0011, {Vector3(0.0, 0.0, -0.002)});
  EXPECT_EQ(simulator.stepCount(), 3);
  simulator.advance(0.001, {Vector3(0.01, 0.0, -0.002)}, limits);  // a diameter of the ball
  EXPECT_GE(simulator.stepCount(), 7);
}

TEST(Simulator, TakesAtMostAsManyStepsAsAllowedAndStillArrives) {
  for (const double sideways : {0.0, 0.3}) {  // m: the ball would have to be sub-stepped for its travel as well
    Simulator simulator = makeScene();
    simulator.advance(0.05, {Vector3(sideways, 0.0, -0.004)}, {7, nullptr});
    EXPECT_EQ(simulator.stepCount(), 7);
    EXPECT_EQ(simulator.report().substeps, 7);
    EXPECT_FALSE(simulator.report().jumped);
    EXPECT_EQ(simulator.jointPositions(0), VectorX(Vector3(sideways, 0.0, -0.004)));
  }
}

TEST(Simulator, AJumpKeepsToTheStepsAllowed) {
  Simulator simulator = makeScene();
  simulator.advance(0.05, {Vector3(900.0, 0.0, 0.0)}, {3, nullptr});
  EXPECT_TRUE(simulator.report().jumped);
  EXPECT_EQ(simulator.stepCount(), 3);
}

TEST(Simulator, StopsBetweenStepsWhenInterruptedAndGoesOnFromThere) {
  Simulator simulator = makeScene();
  simulator.advance(0.05, {Vector3(0.0, 0.0, -0.004)}, {0, [&] { return simulator.stepCount() == 20; }});
  EXPECT_TRUE(simulator.report().interrupted);
  EXPECT_EQ(simulator.report().substeps, 20);
  EXPECT_DOUBLE_EQ(simulator.report().advanced_s, 0.02);
  EXPECT_DOUBLE_EQ(simulator.jointPositions(0).z(), -0.0016);
  simulator.advance(0.03, {Vector3(0.0, 0.0, -0.004)});
  EXPECT_FALSE(simulator.report().interrupted);

  Simulator whole = makeScene();
  whole.advance(0.05, {Vector3(0.0, 0.0, -0.004)});
  // The same motion cut in two: round-off of where the ball is, met by what the solver's tolerance leaves open.
  EXPECT_NEAR(simulator.wrench(0).force.z(), whole.wrench(0).force.z(), 1e-3 * whole.wrench(0).force.z());
}

TEST(Simulator, RefusesADurationOfMoreStepsThanCanBeCounted) {
  Simulator simulator = makeScene();
  for (const double duration : {3e6, 1e300}) {  // at 1 ms: 3e9 steps and more
    EXPECT_THROW(simulator.advance(duration, {Vector3(0.0, 0.0, -0.001)}), std::invalid_argument);
    EXPECT_THROW(simulator.advance(duration, {Vector3(0.0, 0.0, -0.001)}, {3, nullptr}), std::invalid_argument);
  }
  EXPECT_EQ(simulator.stepCount(), 0);
  EXPECT_EQ(simulator.jointPositions(0), VectorX(Vector3::Zero()));
}

TEST(Simulator, MomentumResidualOfTissueThatCreepsBackToRestIsSmall) {
  // Steps and a Poisson's ratio so large that the sweeps run out. The load dies away: beside it alone, a millionth of a
  // newton that they leave was 1.2.
  Simulator simulator = makeScene(0.01, 0.026, "0.499");
  double largest = 0.0;
  for (int i = 1; i < 200; ++i) {
    const double down = i < 50 ? i / 50.0 : std::max(0.0, 2.0 - i / 50.0);
    simulator.advance(0.01, {Vector3(0.0, 0.0, -0.006 * down)});
    const StepReport& report = simulator.report();
    if (i < 110 || report.static_contacts + report.kinetic_contacts > 0) continue;
    largest = std::max(largest, simulator.residuals().momentum);
  }
  EXPECT_LT(largest, 1e-2);  // a hundredth of the weight; 1.2e-3 measured
  EXPECT_GT(largest, 0.0);
}

TEST(Simulator, ResidualsAreThoseOfTheLastStepWheneverAskedFor) {
  Simulator simulator = makeScene();
  EXPECT_EQ(simulator.residuals().momentum_defect_n_s, 0.0);
  std::vector<NodalVectors> scratch;
  for (int k = 1; k <= 30; ++k) {
    simulator.advance(0.005, {Vector3(0.0, 0.0, -1e-4 * k)});
    if (k % 10 != 0) continue;  // nobody asks after the other steps
    const Residuals expected = computeResiduals(simulator.lastProblem(), simulator.lastSolution(), scratch);
    EXPECT_GT(expected.momentum, 0.0);
    for (int asked = 0; asked < 2; ++asked) {
      EXPECT_EQ(simulator.residuals().momentum, expected.momentum);
      EXPECT_EQ(simulator.residuals().cone_violation_n, expected.cone_violation_n);
    }
  }
  simulator.reset();
  EXPECT_EQ(simulator.residuals().momentum_defect_n_s, 0.0);
}

TEST(Simulator, RefusesBadTargetsAndKeepsItsState) {
  Simulator simulator = makeScene();
  simulator.advance(0.05, {Vector3(0.0, 0.0, -0.003)});
  const NodalVectors before = simulator.positions(0);
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinity = std::numeric_limits<double>::infinity();
  EXPECT_THROW(simulator.advance(nan, {Vector3::Zero()}), std::invalid_argument);
  EXPECT_THROW(simulator.advance(0.0, {Vector3::Zero()}), std::invalid_argument);
  EXPECT_THROW(simulator.advance(0.01, {Vector3(infinity, 0.0, 0.0)}), std::invalid_argument);
  EXPECT_THROW(simulator.advance(0.01, {Vector2(0.0, 0.0)}), std::invalid_argument);
  EXPECT_THROW(simulator.advance(0.01, {}), std::invalid_argument);
  EXPECT_THROW(simulator.placeInstrument(0, Vector3(nan, 0.0, 0.0)), std::invalid_argument);
  EXPECT_EQ(simulator.positions(0), before);
  EXPECT_EQ(simulator.jointPositions(0), VectorX(Vector3(0.0, 0.0, -0.003)));
  expectRefusal([&] { simulator.advance(0.01, {Vector3(0.0, nan, 0.0)}); }, {"joint 'y'"});
}

TEST(Simulator, CutsIntervalsIntoEqualStepsNoLongerThanAsked) {
  Simulator simulator = makeScene();
  simulator.advance(0.0101, {Vector3::Zero()});
  EXPECT_EQ(simulator.report().substeps, 11);
  simulator.advance(0.010, {Vector3::Zero()});  // a whole number of steps up to round-off
  EXPECT_EQ(simulator.report().substeps, 10);
  EXPECT_EQ(simulator.stepCount(), 21);
  simulator.advance(0.001, {Vector3(0.02, 0.0, 0.0)});  // 20 m/s: 4 radii in one step, so 8 steps or more
  EXPECT_GE(simulator.report().substeps, 8);
}

// 0.5 m/s down to 3 mm above the fixed base: with 5 ms steps the path of one step is half the sphere.
TEST(Simulator, FastEntryDoesNotTunnel) {
  for (const double dt : {0.001, 0.005}) {
    Simulator simulator = makeScene(dt);
    for (int k = 1; k <= 6; ++k) {
      simulator.advance(0.005, {Vector3(0.0, 0.0, -0.0025 * k)});
      ASSERT_TRUE(simulator.positions(0).allFinite());
      ASSERT_LT(penetration(simulator), 0.0005) << "dt " << dt << ", step " << k;
    }
    EXPECT_GT(simulator.wrench(0).force.z(), 0.1);
    EXPECT_FALSE(simulator.report().discarded);
  }
}

TEST(Simulator, InstrumentThatStartsInsideIsFreedGently) {
  Simulator simulator = makeScene(0.001, 0.022);  // 3 of 5 mm deep; with its centre below the surface no side is nearer
  double fastest = 0.0;
  for (int k = 0; k < 200; ++k) {
    simulator.advance(0.001, {Vector3::Zero()});
    ASSERT_TRUE(simulator.positions(0).allFinite());
    fastest = std::max(fastest, simulator.velocities(0).colwise().norm().maxCoeff());
  }
  EXPECT_LT(penetration(simulator), 1e-4);
  EXPECT_LT(fastest, 5.0);  // a tenth of the radius per millisecond is 0.5 m/s; ten times that would be an explosion
}

// At most half an extent, 5 mm, per 10 ms: 1 mm in 2 ms. The deepest node moves a tenth more than its contact points, which
// lie in the faces beside it; at a tenth of the extent in each step it would be outside after ten of the short ones.
TEST(Simulator, InstrumentThatStartsInsideIsFreedAsFastInShortSteps) {
  const auto freed = [](double dt) {
    Simulator simulator = makeScene(dt, 0.022);
    const double before = penetration(simulator);
    simulator.advance(0.002, {Vector3::Zero()});
    return before - penetration(simulator);
  };
  EXPECT_NEAR(freed(0.001), 0.001, 0.0002);
  EXPECT_NEAR(freed(0.0001), freed(0.001), 1e-5);
}

TEST(Simulator, JumpIsNotSweptAndStaysFinite) {
  Simulator simulator = makeScene();
  simulator.advance(0.1, {Vector3(0.0, 0.0, -0.004)});
  simulator.advance(0.01, {Vector3(1e3, 0.0, 0.0)});
  EXPECT_TRUE(simulator.report().jumped);
  EXPECT_LE(simulator.report().substeps, 10);
  EXPECT_EQ(simulator.wrench(0).force, Vector3::Zero());
  for (int k = 0; k < 300; ++k) simulator.advance(0.001, {Vector3(1e3, 0.0, 0.0)});
  EXPECT_FALSE(simulator.report().jumped);
  // Released: back at rest, up to what damping leaves after 0.3 s.
  EXPECT_LT((simulator.positions(0) - simulator.tissues()[0].restPositions()).colwise().norm().maxCoeff(), 1e-5);
}

TEST(Simulator, MotionFasterThanAnyInstrumentIsAJump) {
  // Half the ball's radius in a travel step, in the air, within a millisecond.
  const double farthest_m = InstrumentMotion::kMaxTravelStepsPerSecond * 0.001 * 0.5 * 0.005;
  for (const double share : {0.9, 1.1}) {
    Simulator simulator = makeScene();
    simulator.advance(0.001, {Vector3(share * farthest_m, 0.0, 0.0)});
    EXPECT_EQ(simulator.report().jumped, share > 1.0) << share;
    EXPECT_EQ(simulator.jointPositions(0), VectorX(Vector3(share * farthest_m, 0.0, 0.0)));
  }
}

// A full turn within one interval ends where it began: it must not count as standing still.
TEST(Simulator, LargeJointMovesAreCutIntoSteps) {
  Simulator simulator = makeScene(0.1);
  simulator.advance(0.1, {Vector3(3.5, 0.0, 0.5)});
  EXPECT_GE(simulator.report().substeps, 4);
}

TEST(Simulator, StepWithoutFiniteAnswerIsDiscardedAndSaidSo) {
  Scene scene = makeScene().scene();
  scene.gravity_m_per_s2 = Vector3(0.0, 0.0, -1e308);  // beyond what the loader allows: overflows within a step of 10 s
  scene.step.max_step_s = 10.0;
  Simulator simulator(scene, ownEnvironment({{"probe", probeUrdf(0.005)}}));
  simulator.advance(10.0, {Vector3::Zero()});
  EXPECT_TRUE(simulator.report().discarded);
  EXPECT_NE(simulator.report().stop, StopReason::kTolerance);
  EXPECT_EQ(simulator.positions(0), simulator.tissues()[0].restPositions());
  EXPECT_EQ(simulator.wrench(0).force, Vector3::Zero());
  EXPECT_EQ(simulator.residuals().momentum, 0.0);
}

TEST(Simulator, FrictionDragsAgainstTheMotion) {
  Simulator simulator = makeScene();
  for (int k = 1; k <= 100; ++k) simulator.advance(0.002, {Vector3(0.0, 0.0, -4e-5 * k)});
  for (int k = 1; k <= 100; ++k) simulator.advance(0.002, {Vector3(8e-5 * k, 0.0, -0.004)});
  EXPECT_LT(simulator.wrench(0).force.x(),
            -0.08 * simulator.wrench(0).force.z());  // mu is 0.4, less what the slope of the dent gives
  EXPECT_GT(simulator.report().kinetic_contacts, 0);
  for (const SolvedContact& contact : simulator.contacts()) {
    const Vector3 n = contact.contact.R_WC.col(0);
    const double normal = contact.force_on_tissue_n.dot(n);
    const double friction = (contact.force_on_tissue_n - normal * n).norm();
    EXPECT_GE(normal, 0.0);
    EXPECT_LE(friction, 0.5 * normal + 1e-12);
    if (contact.state == ContactState::kKinetic) {
      EXPECT_NEAR(friction, 0.4 * normal, 1e-12);
    }
  }
}

}  // namespace simulator_test
}  // namespace tissue_contact
