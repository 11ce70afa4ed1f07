/// @file
/// Messages to what the simulation takes, and what it gives to messages.
#include "ros/conversions.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>

#include "support/text_scene.h"

namespace tissue_contact {
namespace conversions_test {

constexpr std::int64_t kSecond = 1000000000;

Simulator makeScene() {
  return makeSimulator("world_frame: room\n" + blockScene() + "instruments:\n" +
                       probeEntry("probe", "/probe", "[0, 0, 0.026]"));
}

TEST(Conversions, StampsKeepEveryNanosecond) {
  sensor_msgs::JointState message;
  message.header.stamp = ros::Time(1644257420, 444057563);
  message.name = {"a"};
  message.position = {1.5};
  message.velocity = {-0.25};
  const JointStateSample sample = toSample(message);
  EXPECT_EQ(sample.stamp_ns, 1644257420444057563);
  EXPECT_EQ(sample.names, message.name);
  EXPECT_EQ(sample.positions, message.position);
  EXPECT_EQ(sample.velocities, message.velocity);
  EXPECT_EQ(toTime(sample.stamp_ns), message.header.stamp);
}

TEST(Conversions, StatusTellsOfJumps) {
  Simulator simulator = makeScene();
  const JointStatePlayer player(simulator);
  Status status;
  simulator.advance(0.01, {Vector3(0, 0, -0.0005)});
  fillStatus(simulator, player, kSecond, status);
  EXPECT_FALSE(status.jumped);
  EXPECT_FALSE(status.discarded);
  simulator.advance(0.01, {Vector3(1e3, 0, 0)});
  fillStatus(simulator, player, kSecond, status);
  EXPECT_TRUE(status.jumped);
  EXPECT_TRUE(isFinite(simulator));
}

TEST(Conversions, StatusTellsOfSleep) {
  Scene scene = makeScene().scene();
  scene.gravity_m_per_s2 = Vector3(0, 0, -1.0);  // something to be held against
  Simulator simulator(scene, ownEnvironment());
  const JointStatePlayer player(simulator);
  Status status;
  simulator.advance(0.01, {Vector3(0, 0, 0.01)});
  fillStatus(simulator, player, kSecond, status);
  EXPECT_EQ(status.sleeping_nodes, 0U);
  for (int k = 0; k < 300; ++k) simulator.advance(0.01, {Vector3(0, 0, 0.01)});
  fillStatus(simulator, player, kSecond, status);
  EXPECT_GT(status.sleeping_nodes, 0U);
  EXPECT_GT(status.held_force, 0.0);
  EXPECT_EQ(status.held_force, simulator.report().held_force_n);
}

TEST(Conversions, StatusOfADiscardedStepIsFiniteAndSaysSo) {
  Scene scene = makeScene().scene();
  scene.gravity_m_per_s2 = Vector3(0, 0, -1e308);  // beyond what the loader allows: overflows within a step of 10 s
  scene.step.max_step_s = 10.0;
  Simulator simulator(scene, ownEnvironment());
  const JointStatePlayer player(simulator);
  simulator.advance(10.0, {Vector3::Zero()});
  Status status;
  fillStatus(simulator, player, kSecond, status);
  EXPECT_TRUE(status.discarded);
  EXPECT_TRUE(isFinite(simulator));
  EXPECT_TRUE(std::isfinite(status.momentum_residual));
  EXPECT_EQ(simulator.wrench(0).force, Vector3::Zero());
}

TEST(Conversions, NoResidualIsOverlookedByTheFiniteCheck) {
  EXPECT_TRUE(isFinite(Residuals()));
  double Residuals::*const all[] = {
      &Residuals::momentum,         &Residuals::momentum_defect_n_s, &Residuals::net_defect_n_s,
      &Residuals::penetration_m,    &Residuals::adhesion_n,          &Residuals::complementarity_w,
      &Residuals::cone_violation_n, &Residuals::static_slip_m_per_s, &Residuals::kinetic_angle_rad};
  static_assert(sizeof(Residuals) == sizeof(all) / sizeof(all[0]) * sizeof(double), "a residual is missing here");
  for (double Residuals::*const one : all) {
    for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
      Residuals residuals;
      residuals.*one = bad;
      EXPECT_FALSE(isFinite(residuals));
    }
  }
}

TEST(Conversions, PosesGoThereAndBack) {
  Pose X = Pose::Identity();
  X.linear() = Eigen::AngleAxisd(1.2, Vector3(1, 2, 3).normalized()).toRotationMatrix();
  X.translation() = Vector3(0.1, -0.2, 0.3);
  EXPECT_TRUE(toPose(toTransform(X)).isApprox(X, 1e-15));
  geometry_msgs::Transform zero;
  EXPECT_THROW(toPose(zero), std::invalid_argument);
  zero.rotation.w = std::numeric_limits<double>::quiet_NaN();
  EXPECT_THROW(toPose(zero), std::invalid_argument);
  zero.rotation.w = 1.0;
  zero.translation.x = std::numeric_limits<double>::infinity();
  EXPECT_THROW(toPose(zero), std::invalid_argument);
}

}  // namespace conversions_test
}  // namespace tissue_contact
