/// Friction laws one by one: forces and limits by hand, the Stribeck table, and every bad number refused by name.
#include "tissue_contact/friction/friction_law.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <limits>

#include "support/refusal.h"

namespace tissue_contact {
namespace friction_law_test {

using Kind = FrictionLawDescription::Kind;

/// Round-off of a handful of operations on numbers of order 1.
constexpr double kRoundOff = 1e-15;
constexpr double kInfinity = std::numeric_limits<double>::infinity();
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

FrictionLawDescription describe(Kind kind, const std::vector<double>& fixed, const std::vector<double>& kinetic,
                                const std::vector<double>& angles_rad = {}) {
  FrictionLawDescription law;
  law.kind = kind;
  law.static_coefficients = fixed;
  law.kinetic_coefficients = kinetic;
  law.angles_rad = angles_rad;
  return law;
}

std::unique_ptr<const AnisotropicFriction> make(Kind kind, const std::vector<double>& fixed,
                                                const std::vector<double>& kinetic,
                                                const std::vector<double>& angles_rad = {}) {
  return makeAnisotropicFriction(describe(kind, fixed, kinetic, angles_rad));
}

void expectNear(const Vector2& actual, const Vector2& expected) {
  EXPECT_LE((actual - expected).norm(), kRoundOff) << actual.transpose() << " instead of " << expected.transpose();
}

TEST(FrictionLaw, IsotropicLawNeedsNoObject) { EXPECT_EQ(make(Kind::kIsotropic, {0.5}, {0.4}), nullptr); }

// d = (3, 4)/5 with mu = (0.8, 0.3): (mu1^2 d1, mu2^2 d2) / |(mu1 d1, mu2 d2)| = (1.92, 0.36) / (5 * 0.53665631...).
TEST(FrictionLaw, OrthotropicForceIsNotCollinear) {
  const auto law = make(Kind::kOrthotropic, {0.8, 0.3}, {0.8, 0.3});
  const double size = std::sqrt(2.4 * 2.4 + 1.2 * 1.2);
  expectNear(law->slidingForce({0.6, 0.8}), Vector2(-1.92, -0.36) / size);
  expectNear(law->slidingForce({1.0, 0.0}), {-0.8, 0.0});
  expectNear(law->slidingForce({0.0, -1.0}), {0.0, 0.3});
}

TEST(FrictionLaw, OrthotropicLimitIsAnEllipse) {
  const auto law = make(Kind::kOrthotropic, {0.8, 0.3}, {0.4, 0.3});
  EXPECT_NEAR(law->use({0.48, 0.24}, false), 1.0, kRoundOff);  // (0.6, 0.8) of the semiaxes
  EXPECT_NEAR(law->use({-0.24, 0.24}, true), 1.0, kRoundOff);
  EXPECT_NEAR(law->use({0.0, -0.6}, false), 2.0, kRoundOff);
}

// The instrument sliding along +axis 1 feels the forward coefficient, against its motion.
TEST(FrictionLaw, AsymmetricLawTellsForwardFromBackward) {
  const auto law = make(Kind::kAsymmetric, {0.2, 0.9, 0.5}, {0.1, 0.8, 0.4});
  expectNear(law->slidingForce({1.0, 0.0}), {-0.1, 0.0});
  expectNear(law->slidingForce({-1.0, 0.0}), {0.8, 0.0});
  expectNear(law->slidingForce({0.0, 1.0}), {0.0, -0.4});
  // Backward quarter ellipse, d = (-3, 4)/5: (mu1^2 d1, mu2^2 d2) / |(mu1 d1, mu2 d2)|, mu = (0.8, 0.4).
  expectNear(law->slidingForce({-0.6, 0.8}), Vector2(0.384, -0.128) / std::hypot(0.48, 0.32));
  EXPECT_NEAR(law->use({-0.2, 0.0}, false), 1.0, kRoundOff);  // what holds it from going forward
  EXPECT_NEAR(law->use({0.9, 0.0}, false), 1.0, kRoundOff);
  EXPECT_NEAR(law->use({0.8 * 0.6, 0.4 * 0.8}, true), 1.0, kRoundOff);
}

TEST(FrictionLaw, LawWithoutFrictionAlongAnAxisHoldsNothingThere) {
  const auto blade = make(Kind::kOrthotropic, {0.0, 0.5}, {0.0, 0.5});
  EXPECT_GT(blade->use({1e-6, 0.1}, false), 1e6);
  EXPECT_NEAR(blade->use({1e-17, 0.25}, false), 0.5, kRoundOff);  // round-off of turning the axes
  EXPECT_EQ(blade->use({0.0, 0.0}, false), 0.0);
  expectNear(blade->slidingForce({1.0, 0.0}), Vector2::Zero());
  expectNear(blade->slidingForce({0.6, 0.8}), {0.0, -0.5});
}

TEST(FrictionLaw, TableIsLinearInBetweenAndPeriodic) {
  const auto law = make(Kind::kTable, {0.5, 0.7, 0.9}, {0.2, 0.4, 0.6}, {0.0, M_PI / 2.0, M_PI});
  const auto mu = [&](double angle) {
    const Vector2 d(std::cos(angle), std::sin(angle));
    const Vector2 f = law->slidingForce(d);
    EXPECT_LE(std::abs(f.x() * d.y() - f.y() * d.x()), kRoundOff);
    return -f.dot(d);
  };
  EXPECT_NEAR(mu(0.0), 0.2, kRoundOff);
  EXPECT_NEAR(mu(M_PI / 4.0), 0.3, kRoundOff);
  EXPECT_NEAR(mu(M_PI), 0.6, kRoundOff);
  EXPECT_NEAR(mu(1.5 * M_PI), 0.4, kRoundOff);  // half way back from 0.6 to 0.2
  EXPECT_NEAR(mu(-M_PI / 4.0), 0.3, kRoundOff);
  EXPECT_NEAR(mu(-1e-300), 0.2, kRoundOff);
  // What holds the instrument from sliding at 90 degrees is a force at -90 degrees.
  EXPECT_NEAR(law->use({0.0, -0.7}, false), 1.0, kRoundOff);
  EXPECT_NEAR(law->use({0.0, -0.4}, true), 1.0, kRoundOff);
}

TEST(FrictionLaw, TableOfOneAngleIsIsotropic) {
  const auto law = make(Kind::kTable, {0.5}, {0.4}, {0.0});
  for (int i = 0; i < 60; ++i) {
    const Vector2 d(std::cos(0.1 * i), std::sin(0.1 * i));
    expectNear(law->slidingForce(d), -0.4 * d);
  }
}

TEST(FrictionLaw, TensorForceAndLimit) {
  const auto law = make(Kind::kTensor, {0.6, 0.2, -0.2, 0.6}, {0.3, 0.1, -0.1, 0.3});
  expectNear(law->slidingForce({0.6, 0.8}), {-0.26, -0.18});
  EXPECT_NEAR(law->use({0.26, 0.18}, true), 1.0, kRoundOff);
  EXPECT_NEAR(law->use({-0.26, -0.18}, false), 0.5, kRoundOff);
}

TEST(FrictionLaw, SingularTensorHoldsOnlyAlongItsRange) {
  const Vector2 along = Vector2(1.0, 2.0) / std::sqrt(5.0);
  const auto law = make(Kind::kTensor, {0.1, 0.2, 0.2, 0.4}, {0.1, 0.2, 0.2, 0.4});  // 0.5 along, 0 across
  EXPECT_NEAR(law->use(0.25 * along, false), 0.5, kRoundOff);
  EXPECT_GT(law->use(Vector2(1e-6, 0.0), false), 1e6);
  const auto none = make(Kind::kTensor, {0.0, 0.0, 0.0, 0.0}, {0.0, 0.0, 0.0, 0.0});
  EXPECT_EQ(none->use(Vector2(0.1, 0.0), true), kInfinity);
  EXPECT_EQ(none->use(Vector2::Zero(), true), 0.0);
}

TEST(FrictionLaw, StribeckTableIsLinearAndHeldBeyondItsEnds) {
  FrictionLawDescription law = describe(Kind::kIsotropic, {0.5}, {0.5});
  EXPECT_EQ(kineticFactor(law, 3.0), 1.0);
  law.speeds_m_per_s = {0.0, 0.01, 0.1};
  law.speed_factors = {1.0, 0.6, 0.8};
  EXPECT_EQ(kineticFactor(law, 0.0), 1.0);
  EXPECT_NEAR(kineticFactor(law, 0.0025), 0.9, kRoundOff);
  EXPECT_NEAR(kineticFactor(law, 0.055), 0.7, kRoundOff);
  EXPECT_EQ(kineticFactor(law, 0.1), 0.8);
  EXPECT_EQ(kineticFactor(law, 5.0), 0.8);
}

TEST(FrictionLaw, PressureTableIsLinearAndHeldBeyondItsEnds) {
  FrictionLawDescription law = describe(Kind::kIsotropic, {0.5}, {0.5});
  EXPECT_EQ(pressureFactor(law, 1e4), 1.0);
  law.pressures_pa = {0.0, 1000.0, 5000.0};
  law.pressure_factors = {2.0, 3.0, 1.0};
  EXPECT_EQ(pressureFactor(law, 0.0), 2.0);
  EXPECT_NEAR(pressureFactor(law, 250.0), 2.25, kRoundOff);
  EXPECT_NEAR(pressureFactor(law, 4000.0), 1.5, kRoundOff);
  EXPECT_EQ(pressureFactor(law, 5000.0), 1.0);
  EXPECT_EQ(pressureFactor(law, 1e9), 1.0);
}

TEST(ContactPlaneFriction, IsotropicLawOpposesSliding) {
  const CoulombLaw law{0.6, 0.3};
  expectNear(kineticFriction(law, {0.6, 0.8}), {-0.18, -0.24});
  EXPECT_NEAR(frictionUse(law, {0.3, 0.0}, false), 0.5, kRoundOff);
  EXPECT_NEAR(frictionUse(law, {0.3, 0.0}, true), 1.0, kRoundOff);
  EXPECT_EQ(frictionUse({0.0, 0.0}, {0.1, 0.0}, false), kInfinity);
  EXPECT_EQ(frictionUse({0.0, 0.0}, {0.0, 0.0}, false), 0.0);
}

// Axis 1 along t2. Tissue sliding along -t2 under the instrument: the instrument goes forward; the friction on the
// tissue is against the tissue's sliding, hence along +t2.
TEST(ContactPlaneFriction, ForwardIsTheInstrumentMovingAlongAxis1) {
  const auto asymmetric = make(Kind::kAsymmetric, {0.2, 0.8, 0.5}, {0.1, 0.6, 0.4});
  CoulombLaw law;
  law.anisotropic = asymmetric.get();
  law.axis = Vector2::UnitY();
  expectNear(kineticFriction(law, {0.0, -1.0}), {0.0, 0.1});
  expectNear(kineticFriction(law, {0.0, 1.0}), {0.0, -0.6});
  expectNear(kineticFriction(law, {1.0, 0.0}), {-0.4, 0.0});
  EXPECT_NEAR(frictionUse(law, {0.0, 0.2}, false), 1.0, kRoundOff);
  EXPECT_NEAR(frictionUse(law, {0.0, -0.2}, false), 0.25, kRoundOff);
  law.kinetic_factor = 0.5;
  expectNear(kineticFriction(law, {0.0, -1.0}), {0.0, 0.05});
  EXPECT_NEAR(frictionUse(law, {0.0, 0.2}, false), 1.0, kRoundOff);
  EXPECT_NEAR(frictionUse(law, {0.0, 0.05}, true), 1.0, kRoundOff);
  law.kinetic_factor = 0.0;
  EXPECT_EQ(frictionUse(law, {0.0, 0.05}, true), kInfinity);
  law.static_factor = 2.0;
  EXPECT_NEAR(frictionUse(law, {0.0, 0.2}, false), 0.5, kRoundOff);
  law.static_factor = 0.0;
  EXPECT_EQ(frictionUse(law, {0.0, 0.2}, false), kInfinity);
}

using Law = FrictionLawDescription;
using List = std::vector<double> Law::*;
constexpr List kStatic = &Law::static_coefficients;
constexpr List kKinetic = &Law::kinetic_coefficients;
constexpr List kAngles = &Law::angles_rad;

struct BadLaw {
  const char* name;
  Kind kind;  ///< spoils the good law of it
  std::function<void(Law&)> spoil;
  std::vector<std::string> message;
};

void PrintTo(const BadLaw& bad, std::ostream* stream) { *stream << bad.name; }

auto entry(List list, std::size_t i, double value) {
  return [=](Law& law) { (law.*list)[i] = value; };
}
auto whole(List list, const std::vector<double>& values) {
  return [=](Law& law) { law.*list = values; };
}
auto coefficients(const std::vector<double>& fixed, const std::vector<double>& kinetic) {
  return [=](Law& law) {
    law.static_coefficients = fixed;
    law.kinetic_coefficients = kinetic;
  };
}
auto speeds(const std::vector<double>& speeds_m_per_s, const std::vector<double>& factors) {
  return [=](Law& law) {
    law.speeds_m_per_s = speeds_m_per_s;
    law.speed_factors = factors;
  };
}
auto pressures(const std::vector<double>& pressures_pa, const std::vector<double>& factors) {
  return [=](Law& law) {
    law.pressures_pa = pressures_pa;
    law.pressure_factors = factors;
  };
}

FrictionLawDescription goodLaw(Kind kind) {
  switch (kind) {
    case Kind::kIsotropic:
      return describe(kind, {0.5}, {0.4});
    case Kind::kOrthotropic:
      return describe(kind, {0.5, 0.6}, {0.4, 0.5});
    case Kind::kAsymmetric:
      return describe(kind, {0.5, 0.6, 0.7}, {0.4, 0.5, 0.6});
    case Kind::kTable:
      return describe(kind, {0.5, 0.6, 0.7}, {0.4, 0.5, 0.6}, {0.0, 2.0, 4.0});
    case Kind::kTensor:
      break;
  }
  return describe(Kind::kTensor, {0.6, 0.1, 0.1, 0.5}, {0.5, 0.1, 0.1, 0.4});
}

TEST(FrictionLaw, GoodLawsAreAccepted) {
  for (const Kind kind : {Kind::kIsotropic, Kind::kOrthotropic, Kind::kAsymmetric, Kind::kTable, Kind::kTensor}) {
    FrictionLawDescription law = goodLaw(kind);
    law.speeds_m_per_s = {0.0, 0.1};
    law.speed_factors = {1.0, 0.0};
    law.pressures_pa = {0.0, 1e9};
    law.pressure_factors = {10.0, 0.0};
    EXPECT_NO_THROW(makeAnisotropicFriction(law)) << static_cast<int>(kind);
  }
}

class BadFrictionLaw : public testing::TestWithParam<BadLaw> {};

TEST_P(BadFrictionLaw, IsRefusedByName) {
  FrictionLawDescription law = goodLaw(GetParam().kind);
  GetParam().spoil(law);
  expectRefusal([&] { makeAnisotropicFriction(law); }, GetParam().message);
}

const BadLaw kBadLaws[] = {
    {"NoCoefficient", Kind::kIsotropic, whole(kStatic, {}), {"static has 0", "1"}},
    {"OneTooMany", Kind::kOrthotropic, whole(kKinetic, {0.4, 0.5, 0.1}), {"orthotropic", "kinetic has 3 values", "2"}},
    {"OneTooFew", Kind::kAsymmetric, whole(kStatic, {0.5, 0.6}), {"asymmetric", "static has 2 values", "3"}},
    {"TensorOfThree", Kind::kTensor, whole(kStatic, {0.6, 0.1, 0.1}), {"tensor", "static has 3 values", "4"}},
    {"TableCount", Kind::kTable, whole(kKinetic, {0.4, 0.5}), {"table", "kinetic has 2 values", "3", "one per angle"}},
    {"Negative", Kind::kIsotropic, entry(kKinetic, 0, -0.1), {"isotropic", "kinetic[0] is -0.1", ">= 0 and <= 1e+06"}},
    {"NegativeAcross", Kind::kOrthotropic, entry(kKinetic, 1, -0.5), {"kinetic[1] is -0.5", ">= 0 and <= 1e+06"}},
    {"NotANumber", Kind::kAsymmetric, entry(kStatic, 2, kNan), {"static[2] is nan"}},
    {"KineticNotANumber", Kind::kTable, entry(kKinetic, 1, kNan), {"kinetic[1] is nan"}},
    {"Infinite", Kind::kTable, entry(kStatic, 0, kInfinity), {"static[0] is inf"}},
    {"Huge", Kind::kIsotropic, entry(kStatic, 0, 1e7), {"static[0] is 10000000"}},
    {"StaticBelowKinetic", Kind::kOrthotropic, entry(kStatic, 1, 0.45), {"static[1] is 0.45", ">= kinetic[1] = 0.5"}},
    {"StaticBelowKineticBackward",
     Kind::kAsymmetric,
     entry(kStatic, 1, 0.45),
     {"static[1] is 0.45", ">= kinetic[1] = 0.5"}},
    {"StaticBelowKineticInTable", Kind::kTable, entry(kStatic, 2, 0.0), {"static[2] is 0", ">= kinetic[2]"}},
    {"NoAngles", Kind::kTable, whole(kAngles, {}), {"angles_rad is empty"}},
    {"AnglesNotFrom0", Kind::kTable, entry(kAngles, 0, 0.5), {"angles_rad[0] is 0.5 rad"}},
    {"AnglesDescend", Kind::kTable, entry(kAngles, 2, 2.0), {"angles_rad[2] is 2 rad", "> 2"}},
    {"AngleNotANumber", Kind::kTable, entry(kAngles, 1, kNan), {"angles_rad[1] is nan"}},
    {"AngleOfATurn", Kind::kTable, entry(kAngles, 2, 2.0 * M_PI), {"angles_rad[2] is 6.28", "< 2 pi"}},
    {"TensorNotFinite", Kind::kTensor, entry(kKinetic, 1, kNan), {"tensor", "kinetic[1] is nan"}},
    {"TensorDrives",
     Kind::kTensor,
     whole(kKinetic, {0.25, 0.5, 0.5, 0.25}),
     {"symmetric part of 'kinetic'", "-0.25", "drives sliding"}},
    // Every entry of `static` is the larger one, yet across the diagonal it holds 0.1 and kinetic friction pulls 0.3.
    {"TensorStaticBelowInOneDirection",
     Kind::kTensor,
     coefficients({0.5, 0.4, 0.4, 0.5}, {0.4, 0.1, 0.1, 0.4}),
     {"S S' - K K'", "static friction is below kinetic"}},
    // Friction acts along axis 1 when sliding, along axis 2 when held: both matrices are singular.
    {"TensorRangesDiffer", Kind::kTensor, coefficients({0.0, 0.0, 0.0, 0.9}, {0.4, 0.0, 0.0, 0.0}), {"S S' - K K'"}},
    {"SpeedCount", Kind::kIsotropic, speeds({0.0}, {}), {"speed_factors has 0", "1"}},
    {"FactorsAlone", Kind::kOrthotropic, speeds({}, {1.0}), {"speed_factors has 1"}},
    {"SpeedsNotFrom0", Kind::kIsotropic, speeds({0.5}, {1.0}), {"speeds_m_per_s[0] is 0.5 m/s", "must be 0"}},
    {"SpeedsDescend", Kind::kTensor, speeds({0.0, 0.2, 0.1}, {1.0, 1.0, 1.0}), {"speeds_m_per_s[2] is 0.1", "> 0.2"}},
    {"FactorAbove1", Kind::kTable, speeds({0.0, 0.2}, {1.0, 1.1}), {"speed_factors[1] is 1.1", ">= 0 and <= 1"}},
    {"FactorNotANumber", Kind::kAsymmetric, speeds({0.0}, {kNan}), {"speed_factors[0] is nan"}},
    {"PressuresAlone", Kind::kTensor, pressures({0.0}, {}), {"pressure_factors has 0"}},
    {"PressuresNotFrom0", Kind::kIsotropic, pressures({600.0}, {1.0}), {"pressures_pa[0] is 600 Pa", "must be 0"}},
    {"PressuresDescend",
     Kind::kTable,
     pressures({0.0, 200.0, 100.0}, {1.0, 1.0, 1.0}),
     {"pressures_pa[2] is 100", "> 200"}},
    {"PressureFactorNegative",
     Kind::kAsymmetric,
     pressures({0.0}, {-0.1}),
     {"pressure_factors[0] is -0.1", ">= 0 and <= 10"}},
    {"PressureFactorNotANumber", Kind::kOrthotropic, pressures({0.0}, {kNan}), {"pressure_factors[0] is nan"}},
};
INSTANTIATE_TEST_SUITE_P(All, BadFrictionLaw, testing::ValuesIn(kBadLaws),
                         [](const testing::TestParamInfo<BadLaw>& bad) { return bad.param.name; });

}  // namespace friction_law_test
}  // namespace tissue_contact
