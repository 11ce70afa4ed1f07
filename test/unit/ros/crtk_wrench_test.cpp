/// @file
/// Wrenches as CRTK has them, against numbers computed by hand.
#include "ros/publish/crtk_wrench.h"

#include <gtest/gtest.h>

#include <cmath>

namespace tissue_contact {
namespace crtk_wrench_test {

const double kQuarter = std::acos(0.0);

void expectNear(const Vector3& got, const Vector3& expected) { EXPECT_LT((got - expected).norm(), 1e-12) << got; }

TEST(CrtkWrench, BodyIsWhatTheArmExerts) {
  const Wrench body = bodyMeasuredForce({Vector3(1.0, 2.0, 3.0), Vector3(0.1, 0.0, -0.3)});
  EXPECT_EQ(body.force, Vector3(-1.0, -2.0, -3.0));
  EXPECT_EQ(body.torque, Vector3(-0.1, 0.0, 0.3));
  EXPECT_FALSE(std::signbit(body.torque.y()));
}

// The tip is 100 mm along x of the arm's base and turned a quarter about its z axis, so that its x axis is the base's y. Tissue pushes it
// with 2 N along its own -x: the arm exerts 2 N along the base's y, which turns about the base's z axis with 0.1 m * 2 N.
TEST(CrtkWrench, SpatialIsAtTheBaseAndInItsAxes) {
  Pose X_BT = Pose::Identity();
  X_BT.linear() = Eigen::AngleAxisd(kQuarter, Vector3::UnitZ()).toRotationMatrix();
  X_BT.translation() = Vector3(0.1, 0.0, 0.0);
  Wrench felt{Vector3(-2.0, 0.0, 0.0), Vector3::Zero()};
  Wrench spatial = spatialMeasuredForce(felt, X_BT);
  expectNear(spatial.force, Vector3(0.0, 2.0, 0.0));
  expectNear(spatial.torque, Vector3(0.0, 0.0, 0.2));
  // A torque of the tissue about the tip's y axis, 0.05 N m: the arm's is about the base's +x axis.
  felt = {Vector3::Zero(), Vector3(0.0, 0.05, 0.0)};
  spatial = spatialMeasuredForce(felt, X_BT);
  expectNear(spatial.force, Vector3::Zero());
  expectNear(spatial.torque, Vector3(0.05, 0.0, 0.0));
}

// The power of the arm's wrench on a rigid motion is the same in either frame.
TEST(CrtkWrench, BothGiveTheSamePower) {
  Pose X_BT = Pose::Identity();
  X_BT.linear() = (Eigen::AngleAxisd(0.7, Vector3(1.0, -2.0, 0.5).normalized())).toRotationMatrix();
  X_BT.translation() = Vector3(0.03, -0.2, 0.11);
  const Wrench felt{Vector3(0.4, -1.0, 2.5), Vector3(0.01, 0.03, -0.02)};
  const Vector3 velocity_T(0.02, 0.01, -0.03);  // of the tip, in its axes
  const Vector3 turning_T(0.5, -0.4, 0.9);
  const Vector3 turning_B = X_BT.linear() * turning_T;
  const Vector3 velocity_B =
      X_BT.linear() * velocity_T + X_BT.translation().cross(turning_B);  // of the body's point at the base
  const Wrench body = bodyMeasuredForce(felt);
  const Wrench spatial = spatialMeasuredForce(felt, X_BT);
  EXPECT_NEAR(body.force.dot(velocity_T) + body.torque.dot(turning_T),
              spatial.force.dot(velocity_B) + spatial.torque.dot(turning_B), 1e-15);
}

}  // namespace crtk_wrench_test
}  // namespace tissue_contact
