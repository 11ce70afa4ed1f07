/// Every solver a scene can name, on the same press and drag.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include "support/text_scene.h"

namespace tissue_contact {
namespace solvers_by_name_test {

Simulator makeScene(const std::string& solver, const std::string& friction = "static: 0.4, kinetic: 0.4") {
  return makeSimulator(blockScene("[0.06, 0.06, 0.03]", "[6, 6, 3]", "poissons_ratio: 0.45") +
                           onlyBall("[0.001, 0.002, 0.0351]") + "friction:\n  - {instrument: probe, tissue: block, " +
                           friction + "}\nsolver: {" + solver + "}\n",
                       {{"probe", probeUrdf(0.005)}});
}

/// Force at the end of a press of 3 mm and a drag of 4 mm, N.
Vector3 pressAndDrag(Simulator& simulator) {
  for (int k = 1; k <= 60; ++k) simulator.advance(0.001, {Vector3(0.0, 0.0, -5e-5 * k)});
  for (int k = 1; k <= 80; ++k) simulator.advance(0.001, {Vector3(5e-5 * k, 2e-5 * k, -0.003)});
  return simulator.wrench(0).force;
}

Vector3 forceWith(const std::string& solver) {
  Simulator simulator = makeScene(solver);
  return pressAndDrag(simulator);
}

TEST(SolversByName, TrueConesAgree) {
  const Vector3 reference = forceWith("method: reference, iterations: 1000, tolerance: 1.0e-10");
  ASSERT_GT(reference.norm(), 0.05);
  // 1 %: the default tolerance, and histories of contacts that share a face and may carry its force in several ways.
  for (const char* solver : {"iterations: 30", "iterations: 3000, tolerance: 1.0e-9", "relaxation: cholesky"}) {
    EXPECT_LE((forceWith(solver) - reference).norm(), 0.01 * reference.norm()) << solver;
  }
}

TEST(SolversByName, RivalsRunAndPressAlike) {
  const Vector3 reference = forceWith("method: reference, iterations: 1000, tolerance: 1.0e-10");
  for (const char* method : {"cone4", "polyhedral", "condensed_lcp", "impulse"}) {
    const Vector3 force = forceWith("method: " + std::string(method));
    EXPECT_NEAR(force.z(), reference.z(), 0.1 * reference.z()) << method;
    EXPECT_LT(force.x(), 0.0) << method;  // friction against the drag, however wrong its size
  }
}

TEST(SolversByName, LinearisedConesRefuseLawsThatDependOnDirection) {
  const std::string law = "law: orthotropic, static: [0.6, 0.3], axis: {link_direction: [1, 0, 0]}";
  for (const char* method : {"cone4", "polyhedral", "condensed_lcp", "impulse"}) {
    EXPECT_THROW(makeScene("method: " + std::string(method), law), std::invalid_argument) << method;
  }
  for (const char* method : {"predictor_corrector", "reference"}) {
    Simulator simulator = makeScene("method: " + std::string(method), law);
    EXPECT_TRUE(pressAndDrag(simulator).allFinite()) << method;
  }
}

TEST(SolversByName, ResetForgetsFactorsSoThatAReplayIsTheSame) {
  Simulator simulator = makeScene("relaxation: cholesky");
  const Vector3 first = pressAndDrag(simulator);
  simulator.reset();
  EXPECT_EQ(pressAndDrag(simulator), first);
}

TEST(SolversByName, AStepWithoutAnAnswerIsDiscardedByAll) {
  for (const char* solver : {"relaxation: cholesky", "method: reference", "method: condensed_lcp", "method: impulse"}) {
    Scene scene = makeScene(solver).scene();
    scene.gravity_m_per_s2 = Vector3(0.0, 0.0, -1e160);  // beyond what the loader allows: squares overflow
    scene.step.max_step_s = 10.0;
    Simulator simulator(scene, ownEnvironment({{"probe", probeUrdf(0.005)}}));
    simulator.advance(10.0, {Vector3::Zero()});
    EXPECT_TRUE(simulator.report().discarded) << solver;
    EXPECT_EQ(simulator.positions(0), simulator.tissues()[0].restPositions()) << solver;
    if (std::string(solver) == "method: condensed_lcp") continue;  // pivoting does not take such short steps
    simulator.advance(1e-152, {Vector3::Zero()});                  // so short that this gravity makes nothing too fast
    EXPECT_FALSE(simulator.report().discarded) << solver << ": nothing of the step before may be left";
  }
}

TEST(SolversByName, ATimeBudgetNeedsAClock) { EXPECT_THROW(makeScene("time_budget_s: 0.001"), std::invalid_argument); }

}  // namespace solvers_by_name_test
}  // namespace tissue_contact
