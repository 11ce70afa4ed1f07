/// The base of a robot by registration: closed form on exact data, what noise does to it, and motions that cannot tell.
#include "ros/place/registration.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "ros/place/roll_pitch_yaw.h"
#include "support/refusal.h"

namespace tissue_contact {
namespace registration_test {

Pose pose(const Vector3& p, const Vector3& axis, double angle) {
  Pose X = Pose::Identity();
  X.translation() = p;
  X.linear() = Eigen::AngleAxisd(angle, axis.normalized()).toRotationMatrix();
  return X;
}

const Pose kBase = pose({0.2, -0.1, 0.3}, {1.0, 0.2, -0.5}, 3.6);

/// A tip that goes by `reach` along the axes of the base; `noise_m` on what is measured.
std::vector<PosePair> motion(const Vector3& reach, double noise_m = 0.0, const Pose& X_TM = Pose::Identity()) {
  std::mt19937 random(7);
  std::normal_distribution<double> normal;
  std::vector<PosePair> pairs;
  for (int i = 0; i < 200; ++i) {
    const auto sample = [&] { return Vector3(normal(random), normal(random), normal(random)); };
    const Pose X_BT = pose(sample().cwiseProduct(reach), sample(), normal(random));
    Pose X_WT = kBase * X_BT * X_TM;
    X_WT.translation() += noise_m * sample();
    pairs.push_back({X_BT, X_WT});
  }
  return pairs;
}

TEST(Registration, IsExactOnExactPoses) {
  // Also in a plane, where a reflection would fit as well.
  for (const Vector3& reach : {Vector3(0.05, 0.03, 0.02), Vector3(0.05, 0.03, 0.0)}) {
    const Registration found = registerBase(motion(reach));
    EXPECT_TRUE(found.X_WB.isApprox(kBase, 1e-12));
    EXPECT_NEAR(found.X_WB.linear().determinant(), 1.0, 1e-12);
    EXPECT_LT(found.largest_m, 1e-15 + 1e-12);
    EXPECT_LT(found.turn_rms_rad, 1e-7);
    EXPECT_LT(found.tip_turn_rad, 1e-7);
    EXPECT_NO_THROW(requireTrustworthy(found));
    for (int axis = 0; axis < 3; ++axis) EXPECT_NEAR(found.spread_m[axis], reach[axis], 0.15 * reach[axis]);
  }
}

TEST(Registration, NoiseIsTheResidual) {
  constexpr double kNoise_m = 5e-4;
  const Registration found = registerBase(motion({0.05, 0.03, 0.02}, kNoise_m));
  EXPECT_NEAR(found.rms_m, std::sqrt(3.0) * kNoise_m, 0.1 * kNoise_m);
  EXPECT_GT(found.largest_m, found.rms_m);
  // Of 200 samples: noise / sqrt(200) in place, that over the reach in angle, each a few times at most.
  EXPECT_LT((found.X_WB.translation() - kBase.translation()).norm(), 5.0 * kNoise_m / std::sqrt(200.0));
  EXPECT_LT((found.X_WB.linear() - kBase.linear()).norm(), 5.0 * kNoise_m / std::sqrt(200.0) / 0.02);
  EXPECT_NO_THROW(requireTrustworthy(found));
}

TEST(Registration, ATipFrameThatIsTurnedIsTold) {
  const Registration found = registerBase(motion({0.05, 0.03, 0.02}, 0.0, pose(Vector3::Zero(), {0.0, 1.0, 1.0}, 1.2)));
  EXPECT_TRUE(found.X_WB.isApprox(kBase, 1e-12));
  EXPECT_NEAR(found.tip_turn_rad, 1.2, 1e-9);
  EXPECT_LT(found.turn_rms_rad, 1e-7);
}

TEST(Registration, AMotionThatCannotTellIsRefused) {
  for (const Vector3& reach : {Vector3(0.0, 0.0, 0.0), Vector3(0.05, 0.0, 0.0), Vector3(0.05, 0.0005, 0.0)}) {
    expectRefusal<std::runtime_error>([&] { requireTrustworthy(registerBase(motion(reach))); },
                                      {"the motion cannot tell", "record a motion"});
  }
}

TEST(Registration, PosesOfAnotherTipAreRefused) {
  // 0.3 m from the tip that the model has: no base fits.
  const auto pairs = motion({0.05, 0.03, 0.02}, 0.0, pose({0.3, 0.0, 0.0}, Vector3::UnitX(), 0.0));
  expectRefusal<std::runtime_error>([&] { requireTrustworthy(registerBase(pairs)); },
                                    {"no base fits", "joint_names", "tip_link"});
}

TEST(RollPitchYaw, AreThoseOfTheRotationOnAWallToo) {
  const auto rotation = [](const Vector3& rpy) -> Matrix3 {
    return (Eigen::AngleAxisd(rpy[2], Vector3::UnitZ()) * Eigen::AngleAxisd(rpy[1], Vector3::UnitY()) *
            Eigen::AngleAxisd(rpy[0], Vector3::UnitX()))
        .toRotationMatrix();
  };
  for (const double pitch : {0.3, M_PI_2 - 1e-6, M_PI_2 - 1e-9, M_PI_2, -M_PI_2 + 1e-9, -M_PI_2}) {
    for (const double roll : {-2.0, 0.0, 1.0}) {
      Matrix3 R = rotation({roll, pitch, 0.7});
      R(2, 1) += 3e-16;  // a registration's round-off: which way both point there says nothing
      R(0, 0) -= 3e-16;
      EXPECT_TRUE(rotation(rollPitchYaw(R)).isApprox(R, 3e-8)) << pitch << ' ' << roll;
    }
  }
}

TEST(PairPoses, AreInterpolatedInTime) {
  const Pose first = pose(Vector3::Zero(), Vector3::UnitZ(), 0.0);
  const Pose second = pose({0.1, 0.0, 0.0}, Vector3::UnitZ(), 0.8);
  const std::vector<StampedPose> measured = {{1000, first}, {2000, second}, {900'000'000, first}};
  const std::vector<StampedPose> tips = {{999, first},         {1000, first},        {1250, first},
                                         {450'000'000, first}, {900'000'000, first}, {900'000'001, first}};
  const std::vector<PosePair> pairs = pairPoses(tips, measured);
  ASSERT_EQ(pairs.size(), 3u);  // none before, in a gap of 0.9 s, behind
  EXPECT_TRUE(pairs[0].X_WT.isApprox(first, 1e-15));
  EXPECT_TRUE(pairs[1].X_WT.isApprox(pose({0.025, 0.0, 0.0}, Vector3::UnitZ(), 0.2), 1e-12));
  EXPECT_TRUE(pairs[2].X_WT.isApprox(first, 1e-15));
  EXPECT_TRUE(pairPoses(tips, {}).empty());
}

}  // namespace registration_test
}  // namespace tissue_contact
