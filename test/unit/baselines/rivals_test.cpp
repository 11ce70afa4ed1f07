/// @file
/// The linearised friction cones of the rivals: exact where they must be, wrong by what theory says where they are not.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "baselines/lemke.h"
#include "baselines/rival_contact.h"

namespace tissue_contact {
namespace rivals_test {

Matrix3 randomCompliance(std::mt19937& random) {
  std::normal_distribution<double> normal;
  Matrix3 root;
  for (int i = 0; i < 9; ++i) root(i) = normal(random);
  return root * root.transpose() + 0.3 * Matrix3::Identity();
}

Vector2 direction(double angle) { return {std::cos(angle), std::sin(angle)}; }

ContactRival rival(SolverMethod method) {
  SolverDescription description;
  description.method = method;
  return rivalContactSolver(description);
}

/// Largest tangential load over normal load, along `angle`, that the contact holds without sliding.
double heldFraction(SolverMethod method, const CoulombLaw& law, double angle) {
  double held = 0.0;
  double slides = 2.0 * law.mu_static;
  for (int step = 0; step < 60; ++step) {
    const double load = 0.5 * (held + slides);
    Vector3 q(-1.0, 0.0, 0.0);
    q.tail<2>() = load * direction(angle);
    const ContactAnswer answer = rival(method)(Matrix3::Identity(), q, law, false, Vector2::Zero());
    (answer.state == ContactState::kStatic ? held : slides) = load;
  }
  return held;
}

/// The conditions of sliding under a polygon, checked on the answer from first principles.
void expectObeysPolygon(const Matrix3& W, const Vector3& q, double mu, const Vector2& axis, int sides,
                        const Vector3& r) {
  const Vector3 u = W * r + q;
  const double scale = q.norm() + (W * r).norm();
  EXPECT_GE(r[0], 0.0);
  EXPECT_NEAR(u[0], 0.0, 1e-10 * scale);
  double most = 0.0;  // dissipated per unit normal impulse at the best corner
  double inside = -1e300;
  for (int k = 0; k < sides; ++k) {
    const double turn = std::atan2(axis.y(), axis.x()) + 2.0 * M_PI * k / sides;
    most = std::max(most, -mu * u.tail<2>().dot(direction(turn)));
    inside = std::max(inside, r.tail<2>().dot(direction(turn + M_PI / sides)) - mu * r[0] * std::cos(M_PI / sides));
  }
  EXPECT_LE(inside, 1e-10 * r.norm());
  EXPECT_NEAR(-u.tail<2>().dot(r.tail<2>()), most * r[0], 1e-10 * scale * r.norm());
}

TEST(Lemke, SolvesALinearComplementarityProblem) {
  Eigen::MatrixXd tableau(2, 4);  // M = (2 1; 1 2), q = (-5, -6): z = (4/3, 7/3)
  tableau << 2, 1, 0, -5, 1, 2, 0, -6;
  Eigen::VectorXi labels(5);
  VectorX z(2);
  const LcpAnswer answer = solveLcp(tableau, labels, z, 100);
  EXPECT_TRUE(answer.solved);
  EXPECT_NEAR(z[0], 4.0 / 3.0, 1e-14);
  EXPECT_NEAR(z[1], 7.0 / 3.0, 1e-14);
}

TEST(Lemke, SaysWhenThereIsNoSolution) {
  Eigen::MatrixXd tableau(2, 4);  // w_0 = -1 - z_0 < 0 whatever z is
  tableau << -1, 0, 0, -1, 0, 1, 0, 1;
  Eigen::VectorXi labels(5);
  VectorX z(2);
  EXPECT_FALSE(solveLcp(tableau, labels, z, 100).solved);
}

TEST(Lemke, KeepsItsPivotLimit) {
  Eigen::MatrixXd tableau(2, 4);
  tableau << 2, 1, 0, -5, 1, 2, 0, -6;
  Eigen::VectorXi labels(5);
  VectorX z(2);
  const LcpAnswer answer = solveLcp(tableau, labels, z, 1);
  EXPECT_FALSE(answer.solved);
  EXPECT_EQ(answer.pivots, 1);
}

TEST(Lemke, DegenerateRandomProblemsEnd) {
  std::mt19937 random(1);
  std::uniform_int_distribution<int> small(-1, 1);
  for (int trial = 0; trial < 2000; ++trial) {
    const int n = 6;
    Eigen::MatrixXd root(n, 3);  // M = root root' is singular, q in its range: many ties, always solvable
    for (int i = 0; i < root.size(); ++i) root(i) = small(random);
    Vector3 direction3;
    for (int i = 0; i < 3; ++i) direction3[i] = small(random);
    const Eigen::MatrixXd M = root * root.transpose();
    const VectorX q = root * direction3;
    Eigen::MatrixXd tableau(n, n + 2);
    tableau.leftCols(n) = M;
    tableau.col(n + 1) = q;
    Eigen::VectorXi labels(2 * n + 1);
    VectorX z(n);
    ASSERT_TRUE(solveLcp(tableau, labels, z, 500).solved) << trial;
    const VectorX w = M * z + q;
    EXPECT_GE(w.minCoeff(), -1e-10);
    EXPECT_NEAR(w.dot(z), 0.0, 1e-9);
  }
}

TEST(Rivals, ObeyTheirPolygonOnRandomContacts) {
  std::mt19937 random(2);
  std::normal_distribution<double> normal;
  std::uniform_real_distribution<double> uniform(0.0, 0.9);
  int sliding = 0;
  for (int trial = 0; trial < 3000; ++trial) {
    const Matrix3 W = randomCompliance(random);
    const Vector3 q(-std::abs(normal(random)), 3.0 * normal(random), 3.0 * normal(random));
    const double mu = uniform(random);
    const Vector2 previous(normal(random), normal(random));
    const int sides = 4 + 2 * (trial % 4);
    const CoulombLaw law = {mu, mu};
    const ContactAnswer cone = solveCone4Contact(W, q, law, false, previous);
    const ContactAnswer polyhedral = solvePolyhedralContact(W, q, law, false, sides);
    const ContactAnswer four = solvePolyhedralContact(W, q, law, false, 4);
    const ContactAnswer fixed_axes = solveCone4Contact(W, q, law, false, Vector2::Zero());
    expectObeysPolygon(W, q, mu, previous.normalized(), 4, cone.impulse);
    expectObeysPolygon(W, q, mu, Vector2::UnitX(), sides, polyhedral.impulse);
    // Two unknowns in closed form or six by pivoting: the same cone.
    EXPECT_LE((four.impulse - fixed_axes.impulse).norm(), 1e-9 * four.impulse.norm()) << trial;
    sliding += cone.state == ContactState::kKinetic ? 1 : 0;
  }
  EXPECT_GT(sliding, 1000);
}

TEST(Rivals, StickAndOpenAsTheTrueCone) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  for (int trial = 0; trial < 500; ++trial) {
    const Matrix3 W = randomCompliance(random);
    const Vector3 q(normal(random), 0.05 * normal(random), 0.05 * normal(random));
    const ContactAnswer exact = solveCoulombContact(W, q, CoulombLaw{0.1, 0.1}, false);
    for (const SolverMethod method : {SolverMethod::kCone4, SolverMethod::kPolyhedral}) {
      const ContactAnswer answer = rival(method)(W, q, CoulombLaw{0.1, 0.1}, false, Vector2::Zero());
      if (exact.state == ContactState::kOpen) {
        EXPECT_EQ(answer.impulse.norm(), 0.0);
      }
      if (answer.state == ContactState::kStatic) {
        EXPECT_LE((answer.impulse - exact.impulse).norm(), 1e-12);
      }
    }
  }
}

TEST(Rivals, Cone4IsExactWhileSlidingStraightOn) {
  std::mt19937 random(4);
  std::normal_distribution<double> normal;
  for (int trial = 0; trial < 200; ++trial) {
    const Matrix3 W = Matrix3::Identity() * (0.1 + std::abs(normal(random)));
    const Vector3 q(-1.0, 3.0 * normal(random), 2.0 + std::abs(normal(random)));  // too fast to stick
    const ContactAnswer exact = solveCoulombContact(W, q, CoulombLaw{0.4, 0.4}, true);
    ASSERT_EQ(exact.state, ContactState::kKinetic);
    const Vector3 u = W * exact.impulse + q;
    const ContactAnswer aligned = solveCone4Contact(W, q, CoulombLaw{0.4, 0.4}, true, u.tail<2>());
    EXPECT_LE((aligned.impulse - exact.impulse).norm(), 1e-12 * exact.impulse.norm());
  }
}

TEST(Rivals, FourFixedSidesErrBy45DegreesOrBy29PerCent) {
  const CoulombLaw law = {0.5, 0.5};
  const auto friction = [&law](double angle) -> Vector2 {
    Vector3 q(-1.0, 0.0, 0.0);
    q.tail<2>() = 1e4 * direction(angle);  // fast: friction hardly changes the direction of sliding
    return solveCone4Contact(Matrix3::Identity(), q, law, true, Vector2::Zero()).impulse.tail<2>();
  };
  const double before = M_PI / 4.0 - 1e-4;
  EXPECT_NEAR((friction(before) - Vector2(-0.5, 0.0)).norm(), 0.0, 1e-12);            // 45 degrees off ...
  EXPECT_NEAR(-friction(before).dot(direction(before)), 0.5 / std::sqrt(2.0), 1e-4);  // ... so 29 % too little drag
  EXPECT_NEAR(friction(M_PI / 4.0).norm(), 0.5 / std::sqrt(2.0), 1e-12);              // right direction, 29 % too small
  EXPECT_NEAR(heldFraction(SolverMethod::kCone4, law, M_PI / 4.0), 0.5 / std::sqrt(2.0), 1e-12);
  EXPECT_NEAR(heldFraction(SolverMethod::kCone4, law, 0.0), 0.5, 1e-12);
  EXPECT_NEAR(heldFraction(SolverMethod::kPolyhedral, law, M_PI / 8.0), 0.5 * std::cos(M_PI / 8.0), 1e-12);
}

TEST(Rivals, HysteresisPicksTheCoefficient) {
  const CoulombLaw law = {0.6, 0.3};
  const Vector3 q(-1.0, 0.45, 0.0);  // between the limits
  for (const SolverMethod method : {SolverMethod::kCone4, SolverMethod::kPolyhedral}) {
    const auto solve = [&](bool was_sliding) {
      return rival(method)(Matrix3::Identity(), q, law, was_sliding, Vector2::Zero());
    };
    EXPECT_EQ(solve(false).state, ContactState::kStatic);
    EXPECT_EQ(solve(true).state, ContactState::kKinetic);
    EXPECT_NEAR(solve(true).impulse[1], -0.3, 1e-12);
  }
}

TEST(Rivals, MoreSidesComeCloserToTheTrueCone) {
  std::mt19937 random(5);
  std::normal_distribution<double> normal;
  double coarse = 0.0;
  double fine = 0.0;
  for (int trial = 0; trial < 300; ++trial) {
    const Matrix3 W = randomCompliance(random);
    const Vector3 q(-1.0, 2.0 * normal(random), 2.0 * normal(random));
    const ContactAnswer exact = solveCoulombContact(W, q, CoulombLaw{0.3, 0.3}, false);
    const auto error = [&](int sides) {
      return (solvePolyhedralContact(W, q, CoulombLaw{0.3, 0.3}, false, sides).impulse - exact.impulse).norm() /
             exact.impulse.norm();
    };
    coarse += error(4);
    fine += error(64);
  }
  EXPECT_LT(fine, 0.1 * coarse);
  EXPECT_LT(fine, 300 * 0.03);
}

}  // namespace rivals_test
}  // namespace tissue_contact
