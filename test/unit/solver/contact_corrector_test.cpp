/// What the corrector remembers of a contact within a step.
#include "solver/contact_corrector.h"

#include <gtest/gtest.h>

namespace tissue_contact {
namespace contact_corrector_test {

const Matrix3 kW = 0.5 * Matrix3::Identity();
const Vector2 kNoSliding = Vector2::Zero();

TEST(ContactCorrector, HoldsAContactThatKeepsChangingToTheKineticLimit) {
  ContactCorrector corrector;
  ContactState state = ContactState::kStatic;
  const auto solve = [&](double tangential) {
    return state = corrector.solve(0, kW, Vector3(-1.0, tangential, 0.0), {0.5, 0.3}, false, state).state;
  };
  for (int step = 0; step < 2; ++step) {
    corrector.prepare(1, [](std::size_t) { return kNoSliding; });
    state = ContactState::kStatic;
    for (int twice = 0; twice < 12; ++twice) {  // 24 changes are allowed
      EXPECT_EQ(solve(2.0), ContactState::kKinetic);
      EXPECT_EQ(solve(0.4), ContactState::kStatic);  // between the limits
    }
    EXPECT_EQ(solve(2.0), ContactState::kKinetic);
    EXPECT_EQ(solve(0.4), ContactState::kKinetic);
    EXPECT_EQ(solve(0.2), ContactState::kStatic);
    EXPECT_EQ(solve(0.4), ContactState::kKinetic);
  }
}

TEST(ContactCorrector, AContactThatWasSlidingHasTheKineticLimit) {
  ContactCorrector corrector;
  corrector.prepare(1, [](std::size_t) { return kNoSliding; });
  const Vector3 q(-1.0, 0.4, 0.0);
  EXPECT_EQ(corrector.solve(0, kW, q, {0.5, 0.3}, false, ContactState::kOpen).state, ContactState::kStatic);
  EXPECT_EQ(corrector.solve(0, kW, q, {0.5, 0.3}, true, ContactState::kOpen).state, ContactState::kKinetic);
}

/// One contact that was static.
ContactProblem staticContact() {
  ContactProblem problem;
  problem.contacts.emplace_back();
  problem.contacts[0].was_static = true;
  problem.contacts[0].law = {0.5, 0.3};
  return problem;
}

TEST(ContactCorrector, AContactThatWasStaticHasTheStaticLimitUntilItIsReleased) {
  ContactCorrector corrector;
  const ContactProblem problem = staticContact();
  const Vector3 within(-1.0, 0.4, 0.0);
  const Vector3 beyond(-1.0, 0.8, 0.0);
  const auto frictionOf = [&](const Vector3& q) {
    const Vector3 r = corrector.solve(0, kW, q, problem.contacts[0].law, false, ContactState::kStatic).impulse;
    return -r[1] / r[0];
  };
  corrector.prepare(1, [](std::size_t) { return kNoSliding; });
  corrector.hold(problem);
  for (int visit = 0; visit < 100; ++visit) {
    EXPECT_DOUBLE_EQ(frictionOf(within), 0.4);
    EXPECT_DOUBLE_EQ(frictionOf(beyond), 0.5);
  }
  EXPECT_DOUBLE_EQ(frictionOf(within), 0.4);
  EXPECT_FALSE(corrector.releaseOverloaded());  // it is held again
  EXPECT_DOUBLE_EQ(frictionOf(beyond), 0.5);
  EXPECT_TRUE(corrector.releaseOverloaded());
  EXPECT_DOUBLE_EQ(frictionOf(beyond), 0.3);
  EXPECT_FALSE(corrector.releaseOverloaded());
}

TEST(ContactCorrector, AllAreReleasedWithinTheLimitAsWell) {
  ContactCorrector corrector;
  const ContactProblem problem = staticContact();
  corrector.prepare(1, [](std::size_t) { return kNoSliding; });
  corrector.hold(problem);
  EXPECT_FALSE(corrector.releaseAll());  // none was beyond it
  const Vector3 beyond(-1.0, 0.8, 0.0);
  const Vector3 r = corrector.solve(0, kW, beyond, problem.contacts[0].law, false, ContactState::kStatic).impulse;
  EXPECT_DOUBLE_EQ(-r[1] / r[0], 0.3);
}

TEST(ContactCorrector, ARivalIsToldHowTheContactSlidBefore) {
  Vector2 told = kNoSliding;
  ContactCorrector corrector([&](const Matrix3&, const Vector3&, const CoulombLaw&, bool, const Vector2& previous) {
    told = previous;
    return ContactAnswer();
  });
  corrector.prepare(2, [](std::size_t c) { return Vector2(1.0, static_cast<double>(c)); });
  corrector.solve(1, kW, Vector3::Zero(), {}, false, ContactState::kOpen);
  EXPECT_EQ(told, Vector2(1.0, 1.0));
}

}  // namespace contact_corrector_test
}  // namespace tissue_contact
