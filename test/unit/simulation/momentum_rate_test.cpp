// What implicit Euler leaves out of the forces on a tissue, from its momenta.
#include "simulation/momentum_rate.h"

#include <gtest/gtest.h>

#include <cmath>

namespace tissue_contact {
namespace momentum_rate_test {

/// Momentum of a body of .2 kg that swings by 10 mm at `omega`, N s.
Vector3 swinging(double omega, double t) { return Vector3(0.2 * 0.01 * omega * std::cos(omega * t), 0.0, 0.0); }

TEST(MomentumRate, IsHalfTheStepTimesTheSecondDerivative) {
  constexpr double kOmega = 20.0;
  for (const double dt : {0.001, 0.0005}) {
    MomentumRate rate;
    for (int k = 0; k <= 100; ++k) rate.step(swinging(kOmega, k * dt), dt);
    const double middle = 99.0 * dt;  // of the three momenta
    const double second = 0.2 * 0.01 * kOmega * kOmega * kOmega * std::abs(std::cos(kOmega * middle));
    EXPECT_NEAR(rate.defect(), 0.5 * dt * second, 1e-3 * dt * second);
  }
}

TEST(MomentumRate, OfAShortStepAfterALongOneIsThatOfTheShortOne) {
  MomentumRate rate;
  const auto momentum = [](double t) { return Vector3(t * t, 0.0, 0.0); };  // rate 2 t, mean over a step in its middle
  rate.step(momentum(0.0), 0.01);
  rate.step(momentum(0.01), 0.01);
  rate.step(momentum(0.02), 0.01);
  rate.step(momentum(0.022), 0.002);
  EXPECT_NEAR(rate.defect(), 2.0 * 0.022 - 2.0 * 0.021, 1e-12);
}

TEST(MomentumRate, OfAFreeFallIsNone) {
  MomentumRate rate;
  for (int k = 1; k <= 10; ++k) rate.step(Vector3(0.0, 0.0, -9.81 * 0.001 * k), 0.001);
  EXPECT_NEAR(rate.defect(), 0.0, 1e-12);
}

TEST(MomentumRate, IsNotKnownBeforeTheThirdStep) {
  MomentumRate rate;
  for (const double momentum : {1.0, 3.0}) {
    rate.step(Vector3(momentum, 0.0, 0.0), 0.001);
    EXPECT_EQ(rate.defect(), 0.0);
  }
  rate.step(Vector3(4.0, 0.0, 0.0), 0.001);
  EXPECT_NEAR(rate.defect(), 500.0, 1e-9);  // rates 2000 and 1000 N
  EXPECT_NEAR(rate.size(), 1000.0, 1e-9);
  rate.clear();
  rate.step(Vector3(9.0, 0.0, 0.0), 0.001);
  EXPECT_EQ(rate.defect(), 0.0);
  EXPECT_EQ(rate.size(), 0.0);
}

}  // namespace momentum_rate_test
}  // namespace tissue_contact
