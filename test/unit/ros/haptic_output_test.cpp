/// @file
/// What a haptic device is told: scale, turn, bounds, and zero for what is stale or not finite.
#include "ros/haptics/haptic_output.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace tissue_contact {
namespace haptic_output_test {

constexpr std::int64_t kMs = 1000000;  // ns

TEST(HapticOutput, ScalesAndTurns) {
  HapticOptions options;
  options.force_scale = -0.5;
  options.torque_scale = 2.0;
  options.R_DW = Eigen::AngleAxisd(std::acos(0.0), Vector3::UnitZ()).toRotationMatrix();
  HapticOutput output(options);
  output.take({Vector3(1.0, 0.0, 2.0), Vector3(0.0, 0.01, 0.0)}, 0);
  EXPECT_LT((output.command(0).force - Vector3(0.0, -0.5, -1.0)).norm(), 1e-15);
  EXPECT_LT((output.command(0).torque - Vector3(-0.02, 0.0, 0.0)).norm(), 1e-15);
}

TEST(HapticOutput, CutsLengthsAndKeepsDirections) {
  HapticOptions options;
  options.torque_scale = 1.0;
  HapticOutput output(options);
  output.take({Vector3(30.0, 0.0, -40.0), Vector3(0.0, 1e300, 0.0)}, 0);
  EXPECT_LT((output.command(0).force - Vector3(1.2, 0.0, -1.6)).norm(), 1e-15);
  EXPECT_LT((output.command(0).torque - Vector3(0.0, 0.05, 0.0)).norm(), 1e-15);
  output.take({Vector3(1e300, 0.0, 0.0), Vector3::Zero()}, 0);
  EXPECT_EQ(output.command(0).force, Vector3(2.0, 0.0, 0.0));
}

TEST(HapticOutput, IsZeroBeforeTheFirstAndWhenStale) {
  HapticOutput output(HapticOptions{});
  EXPECT_TRUE(output.isStale(0));
  EXPECT_EQ(output.command(0).force, Vector3(0.0, 0.0, 0.0));
  output.take({Vector3(1.0, 0.0, 0.0), Vector3::Zero()}, 100 * kMs);
  EXPECT_EQ(output.command(150 * kMs).force, Vector3(1.0, 0.0, 0.0));
  EXPECT_TRUE(output.isStale(151 * kMs));
  EXPECT_EQ(output.command(151 * kMs).force, Vector3(0.0, 0.0, 0.0));
  output.take({Vector3(0.5, 0.0, 0.0), Vector3::Zero()}, 200 * kMs);
  EXPECT_EQ(output.command(200 * kMs).force, Vector3(0.5, 0.0, 0.0));
}

TEST(HapticOutput, IsZeroForWhatIsNotFinite) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double infinite = std::numeric_limits<double>::infinity();
  HapticOutput output(HapticOptions{});
  output.take({Vector3(1.0, 0.0, 0.0), Vector3::Zero()}, 0);
  for (const Wrench& bad :
       {Wrench{Vector3(0.0, nan, 0.0), Vector3::Zero()}, Wrench{Vector3(infinite, 0.0, 0.0), Vector3::Zero()},
        Wrench{Vector3(1.0, 0.0, 0.0), Vector3(0.0, 0.0, nan)}}) {
    output.take(bad, 0);
    EXPECT_EQ(output.command(0).force, Vector3(0.0, 0.0, 0.0));
    EXPECT_EQ(output.command(0).torque, Vector3(0.0, 0.0, 0.0));
  }
  EXPECT_EQ(output.notFinite(), 3);
}

}  // namespace haptic_output_test
}  // namespace tissue_contact
