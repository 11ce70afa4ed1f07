/// @file
/// The linearised friction cones of the rivals: exact where they must be, wrong by what theory says where they are not.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "solver/lemke.h"
#include "solver/rival_contact.h"

namespace tissue_contact {
namespace {

constexpr double kPi = 3.14159265358979323846;

CoulombLaw coulomb(double mu_static, double mu_kinetic) {
  CoulombLaw law;
  law.mu_static = mu_static;
  law.mu_kinetic = mu_kinetic;
  return law;
}

Matrix3 randomCompliance(std::mt19937& random) {
  std::normal_distribution<double> normal;
  Matrix3 root;
  for (int i = 0; i < 9; ++i) root(i) = normal(random);
  return root * root.transpose() + 0.3 * Matrix3::Identity();
}

Vector2 direction(double angle) { return {std::cos(angle), std::sin(angle)}; }

/// Largest tangential load over normal load, along `angle`, that the contact holds without sliding.
double heldFraction(SolverMethod method, int sides, const CoulombLaw& law, double angle) {
  double held = 0.0;
  double slides = 2.0 * law.mu_static;
  for (int step = 0; step < 60; ++step) {
    const double load = 0.5 * (held + slides);
    Vector3 q(-1.0, 0.0, 0.0);
    q.tail<2>() = load * direction(angle);
    const ContactAnswer answer = solveRivalContact(method, sides, Matrix3::Identity(), q, law, false, Vector2::Zero());
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
    const double turn = std::atan2(axis.y(), axis.x()) + 2.0 * kPi * k / sides;
    most = std::max(most, -mu * u.tail<2>().dot(direction(turn)));
    inside = std::max(inside, r.tail<2>().dot(direction(turn + kPi / sides)) - mu * r[0] * std::cos(kPi / sides));
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
  EXPECT_EQ(answer.status, LcpStatus::kSolved);
  EXPECT_NEAR(z[0], 4.0 / 3.0, 1e-14);
  EXPECT_NEAR(z[1], 7.0 / 3.0, 1e-14);
}

TEST(Lemke, SaysWhenThereIsNoSolution) {
  Eigen::MatrixXd tableau(2, 4);  // w_0 = -1 - z_0 < 0 whatever z is
  tableau << -1, 0, 0, -1, 0, 1, 0, 1;
  Eigen::VectorXi labels(5);
  VectorX z(2);
  EXPECT_EQ(solveLcp(tableau, labels, z, 100).status, LcpStatus::kRay);
}

TEST(Lemke, KeepsItsPivotLimit) {
  Eigen::MatrixXd tableau(2, 4);
  tableau << 2, 1, 0, -5, 1, 2, 0, -6;
  Eigen::VectorXi labels(5);
  VectorX z(2);
  const LcpAnswer answer = solveLcp(tableau, labels, z, 1);
  EXPECT_EQ(answer.status, LcpStatus::kPivotLimit);
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
    ASSERT_EQ(solveLcp(tableau, labels, z, 500).status, LcpStatus::kSolved) << trial;
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
    const CoulombLaw law = coulomb(mu, mu);
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
    const ContactAnswer exact = solveCoulombContact(W, q, coulomb(0.1, 0.1), false);
    for (const SolverMethod method : {SolverMethod::kCone4, SolverMethod::kPolyhedral}) {
      const ContactAnswer rival = solveRivalContact(method, 8, W, q, coulomb(0.1, 0.1), false, Vector2::Zero());
      if (exact.state == ContactState::kOpen) {
        EXPECT_EQ(rival.impulse.norm(), 0.0);
      }
      if (rival.state == ContactState::kStatic) {
        EXPECT_LE((rival.impulse - exact.impulse).norm(), 1e-12);
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
    const ContactAnswer exact = solveCoulombContact(W, q, coulomb(0.4, 0.4), true);
    ASSERT_EQ(exact.state, ContactState::kKinetic);
    const Vector3 u = W * exact.impulse + q;
    const ContactAnswer aligned = solveCone4Contact(W, q, coulomb(0.4, 0.4), true, u.tail<2>());
    EXPECT_LE((aligned.impulse - exact.impulse).norm(), 1e-12 * exact.impulse.norm());
  }
}

TEST(Rivals, FourFixedSidesErrBy45DegreesOrBy29PerCent) {
  const CoulombLaw law = coulomb(0.5, 0.5);
  const auto friction = [&law](double angle) -> Vector2 {
    Vector3 q(-1.0, 0.0, 0.0);
    q.tail<2>() = 1e4 * direction(angle);  // fast: friction hardly changes the direction of sliding
    return solveCone4Contact(Matrix3::Identity(), q, law, true, Vector2::Zero()).impulse.tail<2>();
  };
  const double before = kPi / 4.0 - 1e-4;
  EXPECT_NEAR((friction(before) - Vector2(-0.5, 0.0)).norm(), 0.0, 1e-12);            // 45 degrees off ...
  EXPECT_NEAR(-friction(before).dot(direction(before)), 0.5 / std::sqrt(2.0), 1e-4);  // ... so 29 % too little drag
  EXPECT_NEAR(friction(kPi / 4.0).norm(), 0.5 / std::sqrt(2.0), 1e-12);               // right direction, 29 % too small
  EXPECT_NEAR(heldFraction(SolverMethod::kCone4, 0, law, kPi / 4.0), 0.5 / std::sqrt(2.0), 1e-12);
  EXPECT_NEAR(heldFraction(SolverMethod::kCone4, 0, law, 0.0), 0.5, 1e-12);
  EXPECT_NEAR(heldFraction(SolverMethod::kPolyhedral, 8, law, kPi / 8.0), 0.5 * std::cos(kPi / 8.0), 1e-12);
}

TEST(Rivals, HysteresisPicksTheCoefficient) {
  const CoulombLaw law = coulomb(0.6, 0.3);
  const Vector3 q(-1.0, 0.45, 0.0);  // between the limits
  for (const SolverMethod method : {SolverMethod::kCone4, SolverMethod::kPolyhedral}) {
    const auto solve = [&](bool was_sliding) {
      return solveRivalContact(method, 8, Matrix3::Identity(), q, law, was_sliding, Vector2::Zero());
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
    const ContactAnswer exact = solveCoulombContact(W, q, coulomb(0.3, 0.3), false);
    const auto error = [&](int sides) {
      return (solvePolyhedralContact(W, q, coulomb(0.3, 0.3), false, sides).impulse - exact.impulse).norm() /
             exact.impulse.norm();
    };
    coarse += error(4);
    fine += error(64);
  }
  EXPECT_LT(fine, 0.1 * coarse);
  EXPECT_LT(fine, 300 * 0.03);
}

}  // namespace
}  // namespace tissue_contact
