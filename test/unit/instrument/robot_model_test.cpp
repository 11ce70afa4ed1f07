#include "tissue_contact/instrument/robot_model.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <vector>

#include "instrument_fixture.h"

namespace tissue_contact {
namespace robot_model_test {

using Link = RobotModel::Link;

std::vector<Pose> poses(const RobotModel& model, const std::vector<double>& positions) {
  std::vector<Pose> X_BL;
  model.forwardKinematics(Eigen::Map<const VectorX>(positions.data(), static_cast<Eigen::Index>(positions.size())),
                          X_BL);
  return X_BL;
}

const Pose& poseOf(const RobotModel& model, const std::vector<Pose>& X_BL, const std::string& link) {
  return X_BL.at(static_cast<std::size_t>(model.findLink(link)));
}

const char kOrigin[] = "<origin xyz=\"0.1 -0.2 0.3\" rpy=\"0.4 -0.5 0.6\"/>";

/// The pose of kOrigin by the URDF's own definition: fixed-axis roll, pitch, yaw.
Pose origin() {
  return translation(0.1, -0.2, 0.3) * rotation(0.6, Vector3::UnitZ()) * rotation(-0.5, Vector3::UnitY()) *
         rotation(0.4, Vector3::UnitX());
}

TEST(ForwardKinematics, FixedJointIsItsOrigin) {
  const RobotModel model = parse("<link name=\"a\"/><link name=\"b\"/>" + joint("j", "fixed", "a", "b", kOrigin));
  EXPECT_TRUE(model.joints().empty());
  const std::vector<Pose> X = poses(model, {});
  expectSamePose(poseOf(model, X, "a"), Pose::Identity(), 0.0);
  expectSamePose(poseOf(model, X, "b"), origin(), 1e-15);
}

TEST(ForwardKinematics, RevoluteJointTurnsAboutItsNormalizedAxisAfterTheOrigin) {
  const RobotModel model = parse("<link name=\"a\"/><link name=\"b\"/>" +
                                 joint("j", "revolute", "a", "b", std::string(kOrigin) + "<axis xyz=\"0 3 4\"/>"));
  ASSERT_EQ(model.joints().size(), 1u);
  EXPECT_EQ(model.joints()[0].name, "j");
  EXPECT_EQ(model.joints()[0].lower, -1.0);
  EXPECT_EQ(model.joints()[0].upper, 2.0);
  // Rodrigues' formula by hand, about (0, 0.6, 0.8).
  const double q = 0.7;
  Matrix3 cross;
  cross << 0, -0.8, 0.6, 0.8, 0, 0, -0.6, 0, 0;
  Pose turn = Pose::Identity();
  turn.linear() = Matrix3::Identity() + std::sin(q) * cross + (1 - std::cos(q)) * cross * cross;
  expectSamePose(poseOf(model, poses(model, {q}), "b"), origin() * turn, 1e-15);
}

TEST(ForwardKinematics, ContinuousJointTurnsFurtherThanOneRevolution) {
  const RobotModel model =
      parse("<link name=\"a\"/><link name=\"b\"/>" + joint("j", "continuous", "a", "b", "<axis xyz=\"0 0 -1\"/>"));
  EXPECT_EQ(model.joints()[0].lower, -std::numeric_limits<double>::infinity());
  EXPECT_EQ(model.joints()[0].upper, std::numeric_limits<double>::infinity());
  expectSamePose(poseOf(model, poses(model, {0.3 + 4 * M_PI}), "b"), rotation(-0.3, Vector3::UnitZ()), 1e-14);
}

TEST(ForwardKinematics, PrismaticJointSlidesAlongItsTurnedAxis) {
  const RobotModel model = parse("<link name=\"a\"/><link name=\"b\"/>" +
                                 joint("j", "prismatic", "a", "b", std::string(kOrigin) + "<axis xyz=\"0 2 0\"/>"));
  expectSamePose(poseOf(model, poses(model, {-0.05}), "b"), origin() * translation(0, -0.05, 0), 1e-15);
}

TEST(ForwardKinematics, JointWithoutAxisUsesX) {
  const RobotModel model = parse("<link name=\"a\"/><link name=\"b\"/>" + joint("j", "revolute", "a", "b"));
  expectSamePose(poseOf(model, poses(model, {0.4}), "b"), rotation(0.4, Vector3::UnitX()), 1e-15);
}

TEST(ForwardKinematics, LimitsDoNotClampRecordedPositions) {
  const RobotModel model = parse("<link name=\"a\"/><link name=\"b\"/>" + joint("j", "prismatic", "a", "b"));
  expectSamePose(poseOf(model, poses(model, {5.0}), "b"), translation(5, 0, 0), 0.0);
}

TEST(ForwardKinematics, BranchesOfATreeMoveIndependently) {
  // Links and joints in an order that is not the tree's.
  const RobotModel model = parse(
      "<link name=\"right\"/><link name=\"root\"/><link name=\"left\"/><link name=\"hand\"/>" +
      joint("grip", "prismatic", "left", "hand") + joint("r", "revolute", "root", "right", "<axis xyz=\"0 0 1\"/>") +
      joint("l", "revolute", "root", "left", "<axis xyz=\"0 1 0\"/>"));
  EXPECT_EQ(model.links()[0].name, "root");
  for (std::size_t i = 1; i < model.links().size(); ++i) EXPECT_LT(model.links()[i].parent, static_cast<int>(i));
  std::vector<double> positions(3);
  positions[static_cast<std::size_t>(model.findJoint("r"))] = 0.3;
  positions[static_cast<std::size_t>(model.findJoint("l"))] = -0.4;
  positions[static_cast<std::size_t>(model.findJoint("grip"))] = 0.02;
  const std::vector<Pose> X = poses(model, positions);
  expectSamePose(poseOf(model, X, "right"), rotation(0.3, Vector3::UnitZ()), 1e-15);
  expectSamePose(poseOf(model, X, "hand"), rotation(-0.4, Vector3::UnitY()) * translation(0.02, 0, 0), 1e-15);
}

TEST(Mimic, TakesMultiplierAndOffset) {
  const RobotModel model =
      parse("<link name=\"a\"/><link name=\"b\"/><link name=\"c\"/>" + joint("drive", "revolute", "a", "b") +
            joint("follow", "prismatic", "a", "c", "<mimic joint=\"drive\" multiplier=\"-0.5\" offset=\"0.1\"/>"));
  ASSERT_EQ(model.joints().size(), 1u);  // a joint that mimics is not independent
  EXPECT_EQ(model.findJoint("follow"), -1);
  expectSamePose(poseOf(model, poses(model, {0.6}), "c"), translation(-0.5 * 0.6 + 0.1, 0, 0), 1e-16);
}

TEST(Mimic, DefaultsAreOneAndZero) {
  const RobotModel model =
      parse("<link name=\"a\"/><link name=\"b\"/><link name=\"c\"/>" + joint("drive", "prismatic", "a", "b") +
            joint("follow", "prismatic", "a", "c", "<mimic joint=\"drive\"/>"));
  expectSamePose(poseOf(model, poses(model, {0.25}), "c"), translation(0.25, 0, 0), 0.0);
}

TEST(Mimic, ChainsAreComposedWhateverTheirOrder) {
  // c3 -> c2 -> c1 -> drive, the last one first in the file and nearest to the root.
  const RobotModel model =
      parse("<link name=\"a\"/><link name=\"l0\"/><link name=\"l1\"/><link name=\"l2\"/><link name=\"l3\"/>" +
            joint("c3", "prismatic", "a", "l3", "<mimic joint=\"c2\" multiplier=\"-2\" offset=\"0.5\"/>") +
            joint("c2", "prismatic", "a", "l2", "<mimic joint=\"c1\" multiplier=\"3\" offset=\"-0.25\"/>") +
            joint("c1", "prismatic", "a", "l1", "<mimic joint=\"drive\" multiplier=\"0.5\" offset=\"1\"/>") +
            joint("drive", "prismatic", "a", "l0"));
  ASSERT_EQ(model.joints().size(), 1u);
  const double q1 = 0.5 * 0.4 + 1.0;
  const double q2 = 3.0 * q1 - 0.25;
  const double q3 = -2.0 * q2 + 0.5;
  const std::vector<Pose> X = poses(model, {0.4});
  expectSamePose(poseOf(model, X, "l1"), translation(q1, 0, 0), 1e-15);
  expectSamePose(poseOf(model, X, "l2"), translation(q2, 0, 0), 1e-15);
  expectSamePose(poseOf(model, X, "l3"), translation(q3, 0, 0), 1e-14);
}

TEST(RobotModel, RefusesTheWrongNumberOfPositions) {
  const RobotModel model = parse("<link name=\"a\"/><link name=\"b\"/>" + joint("j", "revolute", "a", "b"));
  expectContains(refusal([&] { poses(model, {0.1, 0.2}); }), {"robot 'r'", "got 2", "has 1"});
}

TEST(RobotModel, KeepsItsBufferBetweenCalls) {
  const RobotModel model = parse("<link name=\"a\"/><link name=\"b\"/>" + joint("j", "revolute", "a", "b"));
  std::vector<Pose> X_BL;
  model.forwardKinematics(VectorX::Zero(1), X_BL);
  const Pose* buffer = X_BL.data();
  model.forwardKinematics(VectorX::Ones(1), X_BL);
  EXPECT_EQ(X_BL.data(), buffer);
}

TEST(RobotModel, RefusesBrokenTrees) {
  Link root;
  root.name = "root";
  Link child;
  child.name = "child";
  child.parent = 0;
  EXPECT_NO_THROW(RobotModel("r", {root, child}, {}));
  expectContains(refusal([] { RobotModel("r", {}, {}); }), {"'r'", "no link"});

  Link late = child;
  late.parent = 1;
  expectContains(refusal([&] { RobotModel("r", {root, late}, {}); }), {"'child'", "parent index 1"});
  Link second_root = child;
  second_root.parent = -1;
  expectContains(refusal([&] { RobotModel("r", {root, second_root}, {}); }), {"'child'", "parent index -1"});
  Link undriven = child;
  undriven.motion = Link::Motion::kRevolute;
  expectContains(refusal([&] { RobotModel("r", {root, undriven}, {}); }), {"'child'", "joint index -1"});
  expectContains(refusal([&] { RobotModel("r", {root, child, child}, {}); }), {"two links named 'child'"});
  expectContains(refusal([&] { RobotModel("r", {root}, {{"j"}, {"j"}}); }), {"two joints named 'j'"});
}

TEST(RobotModel, RefusesNumbersThatAreNotFinite) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  Link root;
  root.name = "root";
  Link child;
  child.name = "child";
  child.parent = 0;
  child.joint = 0;
  child.motion = Link::Motion::kPrismatic;
  const auto build = [&](const Link& link) { return RobotModel("r", {root, link}, {{"j"}}); };
  EXPECT_NO_THROW(build(child));

  Link bad = child;
  bad.X_PJ.translation().y() = nan;
  expectContains(refusal([&] { build(bad); }), {"'child'", "origin", "not finite"});
  bad = child;
  bad.axis.z() = nan;
  expectContains(refusal([&] { build(bad); }), {"'child'", "axis", "must be 1"});
  bad = child;
  bad.axis *= 2.0;
  expectContains(refusal([&] { build(bad); }), {"'child'", "axis of length 2"});
  bad = child;
  bad.multiplier = nan;
  expectContains(refusal([&] { build(bad); }), {"'child'", "multiplier", "not finite"});
  bad = child;
  bad.offset = std::numeric_limits<double>::infinity();
  expectContains(refusal([&] { build(bad); }), {"'child'", "offset", "not finite"});
}

}  // namespace robot_model_test
}  // namespace tissue_contact
