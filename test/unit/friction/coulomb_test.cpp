/// One contact: the corrector against closed forms and against the law it has to satisfy.
#include "tissue_contact/friction/coulomb.h"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <random>

#include "tissue_contact/friction/friction_law.h"

namespace tissue_contact {
namespace coulomb_test {

/// Round-off of a handful of operations on numbers of order 1.
constexpr double kRoundOff = 1e-14;

Matrix3 randomCompliance(std::mt19937& random, double coupling) {
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  Matrix3 B;
  for (int i = 0; i < 9; ++i) B.data()[i] = coupling * uniform(random);
  return B * B.transpose() + Matrix3::Identity();
}

TEST(SolveCoulombContact, SeparatingContactGetsNoImpulse) {
  const ContactAnswer answer = solveCoulombContact(Matrix3::Identity(), Vector3(0.1, 5.0, 0.0), {0.5, 0.5}, false);
  EXPECT_EQ(answer.state, ContactState::kOpen);
  EXPECT_EQ(answer.impulse, Vector3::Zero());
}

TEST(SolveCoulombContact, FrictionlessContactIsNormalOnly) {
  Matrix3 W;
  W << 2.0, 0.3, 0.1, 0.3, 1.0, 0.2, 0.1, 0.2, 1.5;
  const ContactAnswer answer = solveCoulombContact(W, Vector3(-1.0, 3.0, -2.0), {0.0, 0.0}, false);
  EXPECT_EQ(answer.impulse, Vector3(0.5, 0.0, 0.0));
}

// The stopping impulse needs 0.4 of the normal one: between mu_k and mu_s the past decides.
TEST(SolveCoulombContact, HysteresisBetweenKineticAndStaticLimit) {
  const Matrix3 W = Matrix3::Identity();
  const Vector3 q(-1.0, 0.4, 0.0);
  const CoulombLaw law{0.6, 0.3};
  EXPECT_EQ(solveCoulombContact(W, q, law, false).state, ContactState::kStatic);
  const ContactAnswer sliding = solveCoulombContact(W, q, law, true);
  EXPECT_EQ(sliding.state, ContactState::kKinetic);
  EXPECT_LE((sliding.impulse - Vector3(1.0, -0.3, 0.0)).norm(), kRoundOff);
  // Slow enough for kinetic friction to stop it: it sticks again.
  EXPECT_EQ(solveCoulombContact(W, Vector3(-1.0, 0.25, 0.0), law, true).state, ContactState::kStatic);
}

TEST(SolveCoulombContact, RandomContactsSatisfySignoriniAndCoulomb) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  int slid = 0;
  int stuck = 0;
  for (int sample = 0; sample < 20000; ++sample) {
    const Matrix3 W = randomCompliance(random, 0.4);
    const Vector3 q(uniform(random), 0.7 * uniform(random), 0.7 * uniform(random));
    const double mu = 0.5 * (1.0 + uniform(random));
    const ContactAnswer answer = solveCoulombContact(W, q, {mu, mu}, false);
    const Vector3 u = W * answer.impulse + q;
    const Vector2 r_t = answer.impulse.tail<2>();
    const Vector2 u_t = u.tail<2>();
    ASSERT_GE(answer.impulse[0], 0.0);
    // Fixed-point iteration to 1e-15 in the direction; errors of a few 1e-13 on numbers of order 1 remain.
    constexpr double kTolerance = 1e-12;
    if (answer.state == ContactState::kOpen) {
      ASSERT_GE(u[0], 0.0);
      continue;
    }
    ASSERT_LE(std::abs(u[0]), kTolerance);
    ASSERT_LE(r_t.norm(), mu * answer.impulse[0] + kTolerance);
    if (answer.state == ContactState::kStatic) {
      ++stuck;
      ASSERT_LE(u_t.norm(), kTolerance);
    } else {
      ++slid;
      ASSERT_LE(r_t.dot(u_t), 0.0);
      ASSERT_LE((r_t * u_t.norm() + mu * answer.impulse[0] * u_t).norm(), kTolerance * (1.0 + u_t.norm()));
    }
  }
  EXPECT_GT(slid, 1000);
  EXPECT_GT(stuck, 1000);
}

// Coupling and friction far beyond the usual, where friction nearly jams the contact and a fixed-point iteration
// between direction and normal impulse diverges.
TEST(SolveCoulombContact, HardContactsAreSolvedAsWell) {
  std::mt19937 random(3);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  int slid = 0;
  for (int sample = 0; sample < 20000; ++sample) {
    const Matrix3 W = randomCompliance(random, 10.0);
    const Vector3 q(-std::abs(uniform(random)), uniform(random), uniform(random));
    const double mu = 1.0 + 0.9 * uniform(random);
    const ContactAnswer answer = solveCoulombContact(W, q, {mu, mu}, false);
    if (answer.state != ContactState::kKinetic) continue;
    ++slid;
    const Vector3& r = answer.impulse;
    const Vector3 u = W * r + q;
    const Vector2 u_t = u.tail<2>();
    ASSERT_LE(std::abs(u[0]), 1e-14 * W.norm() * r.norm());
    // Near jamming r_n is -q_n over a small difference of compliances, which magnifies round-off.
    const double jammed_scale = W.norm() * q.norm() * r.norm() / -q[0];
    ASSERT_LE((r.tail<2>() * u_t.norm() + mu * r[0] * u_t).norm(), 1e-14 * jammed_scale * r.norm());
  }
  EXPECT_GT(slid, 5000);
}

TEST(HoldContact, GivesAllThatStaticFrictionCan) {
  FrictionLawDescription description;
  description.kind = FrictionLawDescription::Kind::kAsymmetric;
  description.static_coefficients = {0.6, 0.9, 0.4};
  description.kinetic_coefficients = {0.3, 0.5, 0.2};
  const auto asymmetric = makeAnisotropicFriction(description);
  CoulombLaw along;
  along.anisotropic = asymmetric.get();
  std::mt19937 random(5);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  int held = 0;
  int at_limit = 0;
  for (int sample = 0; sample < 4000; ++sample) {
    const CoulombLaw law = sample % 2 == 0 ? CoulombLaw{0.6, 0.3} : along;
    const Matrix3 W = randomCompliance(random, 0.3);
    const Vector3 q(-1.0 - uniform(random), uniform(random), uniform(random));
    const Vector3 sticking = -(W.inverse() * q);
    if (!(sticking[0] > 0.0)) continue;
    const ContactAnswer answer = holdContact(W, q, law);
    const Vector3& r = answer.impulse;
    if (answer.state == ContactState::kStatic) {
      ++held;
      ASSERT_EQ(r, sticking);
      ASSERT_LE(frictionUse(law, r.tail<2>(), false), r[0]);
    } else if (W(0, 0) > W.row(0).tail<2>().norm()) {  // else friction may hold it shut
      ++at_limit;
      ASSERT_NEAR(frictionUse(law, r.tail<2>(), false), r[0], 10.0 * kRoundOff * r.norm());
      ASSERT_NEAR(r.tail<2>().normalized().dot(sticking.tail<2>().normalized()), 1.0, kRoundOff);
      ASSERT_NEAR(W.row(0).dot(r) + q[0], 0.0, 10.0 * kRoundOff * W.norm() * r.norm());
    }
  }
  EXPECT_GT(held, 500);
  EXPECT_GT(at_limit, 500);
}

// An impulse that would have to pull: the law of what slides has the last word. Nor is there anything to hold apart.
TEST(HoldContact, LeavesToTheLawWhatItCannotHold) {
  Matrix3 W = Matrix3::Identity();
  W(0, 1) = W(1, 0) = 0.9;
  const Vector3 torn(-0.1, -1.0, 0.0);
  ASSERT_LT(-(W.inverse() * torn)[0], 0.0);
  EXPECT_EQ(holdContact(W, torn, {0.6, 0.3}).impulse, solveCoulombContact(W, torn, {0.6, 0.3}, false).impulse);
  EXPECT_EQ(holdContact(W, Vector3(0.1, 1.0, 0.0), {0.6, 0.3}).state, ContactState::kOpen);
}

}  // namespace coulomb_test
}  // namespace tissue_contact
