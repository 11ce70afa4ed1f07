/// One contact with direction-dependent friction against answers by hand: W = 1/m, so that the tangential velocity
/// after the step is q_t + r_t / m and everything can be followed with pencil and paper.
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "tissue_contact/friction/friction_law.h"

namespace tissue_contact {
namespace anisotropic_contact_test {

using Kind = FrictionLawDescription::Kind;
using LawPointer = std::unique_ptr<const AnisotropicFriction>;

/// Round-off of Newton's iteration on numbers of order 1.
constexpr double kRoundOff = 1e-14;

LawPointer makeLaw(Kind kind, const std::vector<double>& fixed, const std::vector<double>& kinetic) {
  FrictionLawDescription law;
  law.kind = kind;
  law.static_coefficients = fixed;
  law.kinetic_coefficients = kinetic;
  return makeAnisotropicFriction(law);
}

CoulombLaw contactLaw(const LawPointer& anisotropic, double axis_angle = 0.0) {
  CoulombLaw law;
  law.anisotropic = anisotropic.get();
  law.axis = Vector2(std::cos(axis_angle), std::sin(axis_angle));
  return law;
}

double angleOf(const Vector2& v) { return std::atan2(v.y(), v.x()); }

TEST(SolveAnisotropicContact, SeparatingContactGetsNoImpulse) {
  const LawPointer law = makeLaw(Kind::kOrthotropic, {0.5, 0.2}, {0.5, 0.2});
  for (const double q_n : {0.1, 0.0, std::nan("")}) {
    const ContactAnswer answer =
        solveAnisotropicContact(Matrix3::Identity(), Vector3(q_n, 5.0, 0.0), contactLaw(law), false);
    EXPECT_EQ(answer.state, ContactState::kOpen);
    EXPECT_EQ(answer.impulse, Vector3::Zero());
  }
}

TEST(SolveAnisotropicContact, CoulombSolverHandsOver) {
  const LawPointer law = makeLaw(Kind::kOrthotropic, {0.5, 0.2}, {0.5, 0.2});
  const Vector3 q(-1.0, 0.9, -0.4);
  const ContactAnswer expected = solveAnisotropicContact(Matrix3::Identity(), q, contactLaw(law), false);
  const ContactAnswer answer = solveCoulombContact(Matrix3::Identity(), q, contactLaw(law), false);
  EXPECT_EQ(answer.state, ContactState::kKinetic);
  EXPECT_EQ(answer.impulse, expected.impulse);
}

// The same load of 0.3 is held along axis 1 (0.5) and slides along axis 2 (0.2).
TEST(SolveAnisotropicContact, OrthotropicContactHoldsOneWayAndSlidesTheOther) {
  const LawPointer law = makeLaw(Kind::kOrthotropic, {0.5, 0.2}, {0.5, 0.2});
  const Matrix3 W = 0.5 * Matrix3::Identity();
  const ContactAnswer held = solveAnisotropicContact(W, Vector3(-1.0, 0.3, 0.0), contactLaw(law), false);
  EXPECT_EQ(held.state, ContactState::kStatic);
  EXPECT_LE((held.impulse - Vector3(2.0, -0.6, 0.0)).norm(), kRoundOff);
  const ContactAnswer slid = solveAnisotropicContact(W, Vector3(-1.0, 0.0, 0.3), contactLaw(law), false);
  EXPECT_EQ(slid.state, ContactState::kKinetic);
  EXPECT_LE((slid.impulse - Vector3(2.0, 0.0, -0.4)).norm(), kRoundOff);
}

// Chosen backwards: sliding along (0.6, 0.8) at speed 0.5 under mu = (0.8, 0.3), normal impulse 1, axis 1 = t1. The
// friction is -(1.92, 0.36) / |(2.4, 1.2)|, and q_t what is left when it is taken off.
TEST(SolveAnisotropicContact, OrthotropicSlidingByHand) {
  const LawPointer law = makeLaw(Kind::kOrthotropic, {0.8, 0.3}, {0.8, 0.3});
  const Vector2 friction = Vector2(-1.92, -0.36) / std::sqrt(2.4 * 2.4 + 1.2 * 1.2);
  const Vector2 q_t = Vector2(0.3, 0.4) - friction;
  const ContactAnswer answer =
      solveAnisotropicContact(Matrix3::Identity(), Vector3(-1.0, q_t.x(), q_t.y()), contactLaw(law), false);
  EXPECT_EQ(answer.state, ContactState::kKinetic);
  EXPECT_LE((answer.impulse - Vector3(1.0, friction.x(), friction.y())).norm(), kRoundOff);
}

// A serrated jaw whose axis 1 is t2, forward 0.2, backward 0.8. Tissue pushed along -t2 under it: the jaw would go
// forward, and slips; pushed along +t2: it holds.
TEST(SolveAnisotropicContact, AsymmetricContactSlipsForwardAndHoldsBackward) {
  const LawPointer law = makeLaw(Kind::kAsymmetric, {0.2, 0.8, 0.5}, {0.2, 0.8, 0.5});
  const CoulombLaw jaw = contactLaw(law, M_PI / 2.0);
  const ContactAnswer forward = solveAnisotropicContact(Matrix3::Identity(), Vector3(-1.0, 0.0, -0.6), jaw, false);
  EXPECT_EQ(forward.state, ContactState::kKinetic);
  EXPECT_LE((forward.impulse - Vector3(1.0, 0.0, 0.2)).norm(), kRoundOff);
  const ContactAnswer backward = solveAnisotropicContact(Matrix3::Identity(), Vector3(-1.0, 0.0, 0.6), jaw, false);
  EXPECT_EQ(backward.state, ContactState::kStatic);
  EXPECT_LE((backward.impulse - Vector3(1.0, 0.0, -0.6)).norm(), kRoundOff);
}

TEST(SolveAnisotropicContact, TableLooksUpTheInstrumentsDirection) {
  FrictionLawDescription description;
  description.kind = Kind::kTable;
  description.angles_rad = {0.0, M_PI / 2.0, M_PI, 1.5 * M_PI};
  description.static_coefficients = description.kinetic_coefficients = {0.1, 0.2, 0.3, 0.4};
  const LawPointer law = makeAnisotropicFriction(description);
  // Tissue along +t2: the instrument along -axis 2, 270 degrees.
  const ContactAnswer answer =
      solveAnisotropicContact(Matrix3::Identity(), Vector3(-1.0, 0.0, 1.0), contactLaw(law), false);
  EXPECT_EQ(answer.state, ContactState::kKinetic);
  EXPECT_NEAR(answer.impulse[2], -0.4, kRoundOff);
}

// A blade without friction along itself, pushed obliquely: it slides along itself only, and is held across.
TEST(SolveAnisotropicContact, BladeSlidesAlongItselfOnly) {
  const LawPointer law = makeLaw(Kind::kOrthotropic, {0.0, 0.5}, {0.0, 0.5});
  const double angle = 0.7;
  const Vector2 along(std::cos(angle), std::sin(angle));
  const Vector2 across(-along.y(), along.x());
  const Vector2 q_t = 0.8 * along + 0.3 * across;
  const Vector3 q(-1.0, q_t.x(), q_t.y());
  const ContactAnswer answer = solveAnisotropicContact(Matrix3::Identity(), q, contactLaw(law, angle), false);
  EXPECT_EQ(answer.state, ContactState::kKinetic);
  EXPECT_LE((answer.impulse.tail<2>() + 0.3 * across).norm(), kRoundOff);
  EXPECT_LE((q_t + answer.impulse.tail<2>() - 0.8 * along).norm(), kRoundOff);
}

TEST(SolveAnisotropicContact, LawWithoutFrictionGivesTheNormalImpulse) {
  Matrix3 W;
  W << 2.0, 0.3, 0.1, 0.3, 1.0, 0.2, 0.1, 0.2, 1.5;
  for (const Kind kind : {Kind::kOrthotropic, Kind::kAsymmetric, Kind::kTensor}) {
    const std::vector<double> none(kind == Kind::kOrthotropic ? 2 : kind == Kind::kAsymmetric ? 3 : 4, 0.0);
    const LawPointer law = makeLaw(kind, none, none);
    const ContactAnswer answer = solveAnisotropicContact(W, Vector3(-1.0, 3.0, -2.0), contactLaw(law, 0.3), false);
    EXPECT_EQ(answer.state, ContactState::kKinetic);
    EXPECT_EQ(answer.impulse, Vector3(0.5, 0.0, 0.0));
    // Nothing to slide with either: q_t is what the normal impulse takes away.
    const ContactAnswer still = solveAnisotropicContact(W, Vector3(-2.0, -0.3, -0.1), contactLaw(law, 0.3), false);
    EXPECT_LE((still.impulse - Vector3(1.0, 0.0, 0.0)).norm(), kRoundOff);
  }
}

// The stopping impulse needs 0.8 of the static limit along axis 1, 1.6 of the kinetic one: the past decides.
TEST(SolveAnisotropicContact, HysteresisBetweenKineticAndStaticLimit) {
  const LawPointer law = makeLaw(Kind::kOrthotropic, {0.5, 0.2}, {0.25, 0.1});
  const Vector3 q(-1.0, 0.4, 0.0);
  EXPECT_EQ(solveAnisotropicContact(Matrix3::Identity(), q, contactLaw(law), false).state, ContactState::kStatic);
  const ContactAnswer sliding = solveAnisotropicContact(Matrix3::Identity(), q, contactLaw(law), true);
  EXPECT_EQ(sliding.state, ContactState::kKinetic);
  EXPECT_LE((sliding.impulse - Vector3(1.0, -0.25, 0.0)).norm(), kRoundOff);
  const Vector3 slow(-1.0, 0.2, 0.0);
  EXPECT_EQ(solveAnisotropicContact(Matrix3::Identity(), slow, contactLaw(law), true).state, ContactState::kStatic);
}

TEST(SolveAnisotropicContact, KineticFactorScalesForceAndRestickingLimit) {
  const LawPointer law = makeLaw(Kind::kOrthotropic, {0.5, 0.2}, {0.4, 0.2});
  CoulombLaw fast = contactLaw(law);
  fast.kinetic_factor = 0.5;
  const Vector3 q(-1.0, 0.3, 0.0);
  EXPECT_EQ(solveAnisotropicContact(Matrix3::Identity(), q, fast, false).state, ContactState::kStatic);
  const ContactAnswer sliding = solveAnisotropicContact(Matrix3::Identity(), q, fast, true);
  EXPECT_EQ(sliding.state, ContactState::kKinetic);
  EXPECT_LE((sliding.impulse - Vector3(1.0, -0.2, 0.0)).norm(), kRoundOff);
  fast.kinetic_factor = 0.0;
  EXPECT_LE((solveAnisotropicContact(Matrix3::Identity(), q, fast, true).impulse - Vector3::UnitX()).norm(), kRoundOff);
}

// Form I of the validation list, for one contact: a block (mass 1, weight N) on an orthotropic floor, pushed by T at an
// angle phi from axis 1. Just above its limit T_0(phi) it starts off along the normal of the limit ellipse,
// tan theta = (mu1 / mu2)^2 tan phi, not along the load.
TEST(OrthotropicIncline, SlidesOffTheLoadAtThePredictedAngle) {
  const double mu_1 = 0.6;
  const double mu_2 = 0.3;
  const double weight = 9.81;
  const double dt = 1e-3;
  const LawPointer law = makeLaw(Kind::kOrthotropic, {mu_1, mu_2}, {mu_1, mu_2});
  for (int i = 1; i < 18; ++i) {
    const double phi = i * M_PI / 36.0;
    const Vector2 load(std::cos(phi), std::sin(phi));
    const double limit = weight / std::hypot(load.x() / mu_1, load.y() / mu_2);
    constexpr double kExcess = 1e-8;  // turns theta by about as much
    const auto push = [&](double share) {
      const Vector2 q_t = dt * share * limit * load;
      return Vector3(-dt * weight, q_t.x(), q_t.y());
    };
    EXPECT_EQ(solveAnisotropicContact(Matrix3::Identity(), push(1.0 - kExcess), contactLaw(law), false).state,
              ContactState::kStatic);
    const Vector3 q = push(1.0 + kExcess);
    const ContactAnswer answer = solveAnisotropicContact(Matrix3::Identity(), q, contactLaw(law), false);
    ASSERT_EQ(answer.state, ContactState::kKinetic);
    const double theta = std::atan(mu_1 * mu_1 / (mu_2 * mu_2) * std::tan(phi));
    // The velocity is a difference of numbers 1/kExcess times as large: 1e-16 / 1e-8 in its angle, and the 1e-8 itself.
    EXPECT_NEAR(angleOf((q + answer.impulse).tail<2>()), theta, 1e-7) << "load at " << phi;
  }
}

TEST(SolveAnisotropicContact, EqualCoefficientsAreIsotropic) {
  std::mt19937 random(5);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  int slid = 0;
  for (int sample = 0; sample < 5000; ++sample) {
    Matrix3 B;
    for (int i = 0; i < 9; ++i) B.data()[i] = 0.4 * uniform(random);
    const Matrix3 W = B * B.transpose() + Matrix3::Identity();
    const Vector3 q(-std::abs(uniform(random)), uniform(random), uniform(random));
    const double mu = 0.5 * (1.0 + uniform(random));
    const double mu_static = mu * (1.5 + 0.5 * uniform(random));
    const LawPointer law = makeLaw(Kind::kOrthotropic, {mu_static, mu_static}, {mu, mu});
    const ContactAnswer expected = solveCoulombContact(W, q, {mu_static, mu}, sample % 2 == 0);
    const ContactAnswer answer =
        solveAnisotropicContact(W, q, contactLaw(law, M_PI * uniform(random)), sample % 2 == 0);
    ASSERT_EQ(answer.state, expected.state);
    ASSERT_LE((answer.impulse - expected.impulse).norm(), 1e-12 * expected.impulse.norm());
    slid += answer.state == ContactState::kKinetic ? 1 : 0;
  }
  EXPECT_GT(slid, 1000);
}

}  // namespace anisotropic_contact_test
}  // namespace tissue_contact
