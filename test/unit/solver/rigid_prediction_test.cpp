/// Where sweeps begin for bodies that static contacts carry.
#include "solver/rigid_prediction.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <vector>

#include "tissue_contact/contact/contact.h"

namespace tissue_contact {
namespace rigid_prediction_test {

/// Eight corners of a cube of 20 mm about (1, 0, 0), three of them held by a tool that moves and turns about the origin (toolAt).
struct CarriedCube {
  NodalVectors x = NodalVectors(3, 8);
  std::vector<bool> fixed = std::vector<bool>(8, false);
  ContactProblem problem;
  ContactSolution solution;

  CarriedCube() {
    for (int i = 0; i < 8; ++i) {
      x.col(i) = Vector3(1.0, 0.0, 0.0) + 0.01 * Vector3(i & 1 ? 1 : -1, i & 2 ? 1 : -1, i & 4 ? 1 : -1);
    }
    BodySystem body;
    body.x = &x;
    body.fixed = &fixed;
    for (const int node : {0, 3, 5}) {
      ContactRow row;
      row.nodes[0] = {0, node, 1.0};
      row.node_count = 1;
      row.R_WC = Eigen::AngleAxisd(0.3 * node, Vector3(1.0, 2.0, -1.0).normalized()).toRotationMatrix();
      row.u_tool = row.R_WC.transpose() * toolAt(node);
      row.was_static = true;
      row.law = {0.5, 0.5};
      problem.contacts.push_back(row);
    }
    body.mass = VectorX::Constant(8, 0.001);
    problem.bodies = {body};
    solution.impulses.assign(3, Vector3(1.0, 0.0, 0.0));
    solution.states.assign(3, ContactState::kStatic);
    solution.v = {NodalVectors::Zero(3, 8)};
  }
  Vector3 toolAt(int node) const {
    const Vector3 shift(0.1, -0.2, 0.05);
    const Vector3 turn(2.0, -1.0, 3.0);  // rad/s
    return shift + turn.cross(x.col(node));
  }
  double worstError() {
    predictRigidMotions(problem, solution);
    double worst = 0.0;
    for (int i = 0; i < 8; ++i) worst = std::max(worst, (solution.v[0].col(i) - toolAt(i)).norm());
    return worst;
  }
};

TEST(RigidPrediction, ABodyGoesOnWithTheToolThatCarriesIt) {
  CarriedCube scene;
  EXPECT_LT(scene.worstError(),
            1e-4);  // the cost of turning, 1e-6, times speeds of 3 m/s and the cube's distance from where they are 0
}

TEST(RigidPrediction, WhatItDoesBesidesIsKept) {
  CarriedCube scene;
  const Vector3 swells = Vector3(0.0, 0.0, 1.0);
  scene.solution.v[0].col(7) = swells;  // nothing holds it
  scene.worstError();
  EXPECT_LT((scene.solution.v[0].col(7) - scene.toolAt(7) - swells).norm(), 1e-4);
}

TEST(RigidPrediction, OneContactShiftsABodyWithoutTurningIt) {
  CarriedCube scene;
  scene.problem.contacts.resize(1);
  ContactRow& row = scene.problem.contacts[0];
  row.R_WC = contactFrame(scene.toolAt(0).normalized());  // pushes
  row.u_tool = row.R_WC.transpose() * scene.toolAt(0);
  predictRigidMotions(scene.problem, scene.solution);
  for (int i = 0; i < 8; ++i)
    EXPECT_LT((scene.solution.v[0].col(i) - scene.toolAt(0)).norm(), 1e-3) << i;  // of .3 and more
}

TEST(RigidPrediction, PenetrationIsNotMadeDeeper) {
  CarriedCube scene;
  scene.problem.contacts.resize(1);
  scene.problem.contacts[0].required_u_n = 0.3;
  predictRigidMotions(scene.problem, scene.solution);
  EXPECT_NEAR(relativeVelocity(scene.problem.contacts[0], scene.solution.v)[0], 0.3, 1e-5);
}

// A squeezed sheet at rest: required_u_n is what its own compliance makes of the impulse, and so with its shear.
TEST(RigidPrediction, ABodyThatRestsStaysAtRest) {
  CarriedCube scene;
  for (std::size_t c = 0; c < 3; ++c) {
    ContactRow& row = scene.problem.contacts[c];
    row.normal_compliance = 0.2;
    row.tangential_compliance = 0.1;
    scene.solution.impulses[c] = Vector3(1.0, 0.3, -0.2);
    row.required_u_n = 0.2;
    row.u_tool = Vector3(0.0, 0.03, -0.02);
  }
  predictRigidMotions(scene.problem, scene.solution);
  EXPECT_LT(scene.solution.v[0].norm(), 1e-12);
}

// Jaws that close on a body from both sides: what it does on the whole is not what they do.
TEST(RigidPrediction, ContactsThatDisagreeMoveNothing) {
  CarriedCube scene;
  scene.problem.contacts.resize(2);
  for (std::size_t c = 0; c < 2; ++c) {
    ContactRow& row = scene.problem.contacts[c];
    row.nodes[0].node = c == 0 ? 0 : 7;
    row.R_WC = contactFrame((scene.x.col(c == 0 ? 7 : 0) - scene.x.col(c == 0 ? 0 : 7)).normalized());
    row.u_tool = Vector3(0.3, 0.0, 0.0);
  }
  predictRigidMotions(scene.problem, scene.solution);
  EXPECT_TRUE(scene.solution.v[0].isZero(0.0));
}

TEST(RigidPrediction, WhatWithdrawsDoesNotPull) {
  CarriedCube scene;
  scene.problem.contacts.resize(1);
  scene.problem.contacts[0].u_tool = Vector3(-0.3, 0.1, 0.0);
  predictRigidMotions(scene.problem, scene.solution);
  EXPECT_NEAR(relativeVelocity(scene.problem.contacts[0], scene.solution.v)[0], 0.3, 1e-5);
  EXPECT_NEAR(relativeVelocity(scene.problem.contacts[0], scene.solution.v)[1], 0.0, 1e-5);
}

TEST(RigidPrediction, LeavesOtherBodiesAlone) {
  const auto moves = [](const auto& change) {
    CarriedCube scene;
    change(scene);
    predictRigidMotions(scene.problem, scene.solution);
    return !scene.solution.v[0].isZero(0.0);
  };
  EXPECT_TRUE(moves([](CarriedCube&) {}));
  EXPECT_FALSE(moves([](CarriedCube& scene) { scene.fixed[6] = true; }));
  EXPECT_FALSE(moves([](CarriedCube& scene) { scene.problem.bodies[0].asleep = true; }));
  EXPECT_FALSE(moves([](CarriedCube& scene) { scene.problem.bodies[0].x = nullptr; }));
  EXPECT_FALSE(moves([](CarriedCube& scene) {
    for (ContactRow& row : scene.problem.contacts) row.was_static = false;
  }));
  EXPECT_FALSE(moves([](CarriedCube& scene) { scene.solution.states.assign(3, ContactState::kKinetic); }));
  EXPECT_FALSE(moves([](CarriedCube& scene) { scene.problem.bodies[0].mass *= 1e4; }));
  EXPECT_FALSE(moves([](CarriedCube& scene) {
    for (ContactRow& row : scene.problem.contacts) row.pair = -1;  // another tissue
  }));
}

}  // namespace rigid_prediction_test
}  // namespace tissue_contact
