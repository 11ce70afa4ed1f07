/// @file
/// Elimination of the bodies from a step's contact problem, against inverses by hand.
#include "baselines/delassus_system.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <array>
#include <stdexcept>
#include <vector>

namespace tissue_contact {
namespace delassus_system_test {

/// Two free masses joined by a spring, touched at both by contacts; one more node fixed.
struct TwoMasses {
  BlockMatrix K;
  std::vector<bool> fixed = {false, false, true};
  ContactProblem contacts;

  TwoMasses() {
    K = BlockMatrix::forElements(std::vector<std::array<int, 2>>{{0, 1}}, fixed);
    K.diagonal = {2.0 * Matrix3::Identity(), 2.0 * Matrix3::Identity(), Matrix3::Identity()};
    K.add(K.pattern->find(0, 1), -Matrix3::Identity());
    contacts.dt_s = 0.1;
    BodySystem body;
    body.K = &K;
    body.fixed = &fixed;
    body.stiffness_scale = 3.0;
    body.mass = Vector3(1.0, 2.0, 1.0);
    body.b = NodalVectors::Random(3, 3);
    contacts.bodies = {body};
    for (int c = 0; c < 3; ++c) {
      ContactRow row;
      row.node_count = 2;
      row.nodes[0] = {0, 0, 0.25 + 0.25 * c};
      row.nodes[1] = {0, c == 2 ? 2 : 1, 0.75 - 0.25 * c};
      if (c == 2) {  // on the fixed node alone
        row.node_count = 1;
        row.nodes[0] = {0, 2, 1.0};
      }
      row.R_WC = Quaternion(1.0, 0.3 * c, 0.2, -0.4).normalized().toRotationMatrix();
      row.u_tool = Vector3(0.1, 0.2, 0.3) * (c + 1);
      row.required_u_n = 0.05;
      row.law.mu_static = row.law.mu_kinetic = 0.4;
      row.was_sliding = c == 1;
      contacts.contacts.push_back(row);
    }
  }
};

TEST(DelassusSystem, EliminatesTheBodies) {
  const TwoMasses scene;
  const DelassusSystem system(scene.contacts);
  const DelassusProblem& problem = system.problem();
  // By hand: A over the two free nodes, J of the first two contacts.
  Eigen::MatrixXd A = Eigen::MatrixXd::Zero(6, 6);
  A.topLeftCorner<3, 3>() = 7.0 * Matrix3::Identity();
  A.bottomRightCorner<3, 3>() = 8.0 * Matrix3::Identity();
  A.topRightCorner<3, 3>() = A.bottomLeftCorner<3, 3>() = -3.0 * Matrix3::Identity();
  Eigen::MatrixXd J = Eigen::MatrixXd::Zero(9, 6);
  VectorX bias = VectorX::Zero(9);
  for (int c = 0; c < 2; ++c) {
    const ContactRow& row = scene.contacts.contacts[c];
    for (int a = 0; a < 2; ++a) {
      J.block<3, 3>(3 * c, 3 * row.nodes[a].node) = row.nodes[a].weight * row.R_WC.transpose();
    }
    bias.segment<3>(3 * c) = -row.u_tool - Vector3(row.required_u_n, 0.0, 0.0);
  }
  VectorX b(6);
  b << scene.contacts.bodies[0].b.col(0), scene.contacts.bodies[0].b.col(1);
  const Eigen::MatrixXd inverse = A.inverse();
  EXPECT_LE((problem.W - J * inverse * J.transpose()).norm(), 1e-14);
  EXPECT_LE((problem.q - J * inverse * b - bias).norm(), 1e-14);
  EXPECT_TRUE(problem.was_sliding[1]);
  EXPECT_EQ(problem.laws[0].mu_static, 0.4);

  const VectorX r = VectorX::Random(9);
  std::vector<NodalVectors> v;
  system.recoverVelocities(r, v);
  const VectorX expected = inverse * (b + J.transpose() * r);
  EXPECT_LE((v[0].col(0) - expected.head<3>()).norm() + (v[0].col(1) - expected.tail<3>()).norm(), 1e-14);
  EXPECT_EQ(v[0].col(2), Vector3::Zero());
  // The velocities of the answer are the contacts' velocities.
  const VectorX u = problem.W * r + problem.q;
  for (int c = 0; c < 2; ++c) {
    Vector3 relative = relativeVelocity(scene.contacts.contacts[c], v);
    relative[0] -= scene.contacts.contacts[c].required_u_n;
    EXPECT_LE((relative - u.segment<3>(3 * c)).norm(), 1e-14);
  }
}

TEST(DelassusSystem, RefusesAnIndefiniteBody) {
  TwoMasses scene;
  scene.K.diagonal[0] = -5.0 * Matrix3::Identity();
  EXPECT_THROW(makeDelassusProblem(scene.contacts), std::runtime_error);
}

}  // namespace delassus_system_test
}  // namespace tissue_contact
