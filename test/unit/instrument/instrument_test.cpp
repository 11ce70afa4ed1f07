#include "tissue_contact/instrument/instrument.h"

#include <gtest/gtest.h>

#include <limits>
#include <string>
#include <variant>
#include <vector>

#include "instrument_fixture.h"
#include "unit/mesh/mesh_fixture.h"

namespace tissue_contact {
namespace instrument_test {

const double kNan = std::numeric_limits<double>::quiet_NaN();

/// arm: base -> (slide, prismatic x) -> rod -> (turn, revolute z) -> tip; finger mimics turn.
RobotModel arm() {
  return parse(
      "<link name=\"base\"/>"
      "<link name=\"rod\"><visual><geometry><box size=\"1 1 1\"/></geometry></visual><collision><origin xyz=\"0 0 1\"/>"
      "<geometry><sphere radius=\"0.25\"/></geometry></collision><collision><geometry><cylinder radius=\"1\" "
      "length=\"2\"/></geometry></collision></link>"
      "<link name=\"tip\"><visual><geometry><box size=\"1 2 3\"/></geometry></visual></link><link name=\"finger\"/>" +
      joint("slide", "prismatic", "base", "rod") + joint("turn", "revolute", "rod", "tip", "<axis xyz=\"0 0 1\"/>") +
      joint("follow", "revolute", "tip", "finger", "<mimic joint=\"turn\"/>"));
}

InstrumentDescription armDescription() {
  InstrumentDescription description;
  description.name = "arm";
  description.joint_state_topics = {{"/joint_states"}};
  description.tip_link = "tip";
  return description;
}

Instrument make(const InstrumentDescription& description) { return {description, arm(), Pose::Identity()}; }

std::string refusalOf(const InstrumentDescription& description) {
  std::string message = refusal([&] { make(description); });
  expectContains(message, {"instrument 'arm'"});
  return message;
}

TEST(Instrument, LinkPosesAreInTheWorld) {
  const Pose X_WB = translation(1, 2, 3) * rotation(0.5, Vector3(1, 1, 0));
  const Instrument instrument(armDescription(), arm(), X_WB);
  EXPECT_EQ(instrument.name(), "arm");
  EXPECT_FALSE(instrument.isObstacle());
  std::vector<Pose> X_WL;
  VectorX positions(2);
  positions[instrument.jointOfRecordedName("slide")] = 0.1;
  positions[instrument.jointOfRecordedName("turn")] = 0.7;
  instrument.linkPoses(positions, X_WL);
  ASSERT_EQ(X_WL.size(), 4u);
  expectSamePose(X_WL[0], X_WB, 0.0);
  expectSamePose(X_WL[static_cast<std::size_t>(instrument.tipLink())],
                 X_WB * translation(0.1, 0, 0) * rotation(0.7, Vector3::UnitZ()), 1e-15);
}

// Two arms of one model on a topic: that which the map does not mean must not move the other's instrument.
TEST(Instrument, RecordedNamesGoThroughTheMapOrStandForThemselves) {
  InstrumentDescription description = armDescription();
  description.joint_names = {{"outer_slide", "slide"}};
  const Instrument instrument = make(description);
  const int slide = instrument.model().findJoint("slide");
  const int turn = instrument.model().findJoint("turn");
  EXPECT_EQ(instrument.jointOfRecordedName("outer_slide"), slide);
  EXPECT_EQ(instrument.jointOfRecordedName("slide"), -1);
  EXPECT_EQ(instrument.jointOfRecordedName("turn"), turn);
  EXPECT_EQ(instrument.jointOfRecordedName("follow"), -1);
  EXPECT_EQ(instrument.jointOfRecordedName("elsewhere"), -1);
}

TEST(Instrument, TheMapMayGiveAnOwnNameAnotherMeaning) {
  InstrumentDescription description = armDescription();
  description.joint_names = {{"turn", "slide"}, {"slide", "turn"}};
  const Instrument instrument = make(description);
  EXPECT_EQ(instrument.jointOfRecordedName("turn"), instrument.model().findJoint("slide"));
  EXPECT_EQ(instrument.jointOfRecordedName("slide"), instrument.model().findJoint("turn"));
}

TEST(Instrument, AnOwnNameMayStandInTheMap) {
  InstrumentDescription description = armDescription();
  description.joint_names = {{"slide", "slide"}};
  EXPECT_EQ(make(description).jointOfRecordedName("slide"), 0);
}

TEST(Instrument, RefusesBadJointMaps) {
  InstrumentDescription description = armDescription();
  description.joint_names = {{"outer_yaw", "yaw"}};
  expectContains(refusalOf(description), {"'outer_yaw'", "'yaw'", "not an independent joint", "slide, turn"});
  description.joint_names = {{"slide", "outer_slide"}};
  expectContains(refusalOf(description), {"recorded name stands first (outer_slide: slide)", "'outer_slide'"});
  description.joint_names = {{"outer_follow", "follow"}};
  expectContains(refusalOf(description), {"'outer_follow'", "'follow'", "mimic joints cannot be set"});
  description.joint_names = {{"a", "turn"}, {"b", "turn"}};
  expectContains(refusalOf(description), {"both 'a' and 'b'", "'turn'"});
}

TEST(Instrument, InitialPositionsAreZeroUnlessGiven) {
  InstrumentDescription description = armDescription();
  description.initial_joint_positions = {{"turn", 0.25}};
  const Instrument instrument = make(description);
  EXPECT_EQ(instrument.initialPositions()[instrument.model().findJoint("turn")], 0.25);
  EXPECT_EQ(instrument.initialPositions()[instrument.model().findJoint("slide")], 0.0);
}

TEST(Instrument, RefusesBadInitialPositions) {
  InstrumentDescription description = armDescription();
  description.initial_joint_positions = {{"yaw", 0.0}};
  expectContains(refusalOf(description), {"initial position", "'yaw'", "slide, turn"});
  description.initial_joint_positions = {{"follow", 0.0}};
  expectContains(refusalOf(description), {"initial position", "'follow'", "mimic"});
  for (const double bad : {kNan, std::numeric_limits<double>::infinity()}) {
    description.initial_joint_positions = {{"turn", bad}};
    expectContains(refusalOf(description), {"initial position of joint 'turn'", "must be finite"});
  }
}

TEST(Instrument, KnowsItsCompliantJoints) {
  InstrumentDescription description = armDescription();
  description.compliant_joints = {{"turn", false, 0.5, 0.1}, {"slide", true, 1000.0}};
  const Instrument instrument = make(description);
  ASSERT_EQ(instrument.compliantJoints().size(), 2U);
  EXPECT_EQ(instrument.compliantJoints()[0].joint, instrument.model().findJoint("turn"));
  EXPECT_EQ(instrument.compliantJoints()[0].stiffness, 0.5);
  EXPECT_EQ(instrument.compliantJoints()[0].effort_limit, 0.1);
  EXPECT_EQ(instrument.compliantJoints()[1].effort_limit, std::numeric_limits<double>::infinity());
}

TEST(Instrument, RefusesComplianceThatNoJointHas) {
  InstrumentDescription description = armDescription();
  description.compliant_joints = {{"yaw", false, 0.5}};
  expectContains(refusalOf(description), {"compliance", "'yaw'", "slide, turn"});
  description.compliant_joints = {{"follow", false, 0.5}};
  expectContains(refusalOf(description), {"compliance", "'follow'", "mimic"});
  description.compliant_joints = {{"turn", true, 0.5}};
  expectContains(refusalOf(description), {"'turn' turns", "stiffness_n_m_per_rad"});
  description.compliant_joints = {{"slide", false, 0.5}};
  expectContains(refusalOf(description), {"'slide' slides", "stiffness_n_per_m"});
  description.compliant_joints = {{"turn", false, 0.5}, {"turn", false, 0.6}};
  expectContains(refusalOf(description), {"'turn' is named twice"});
  for (const double bad : {0.0, -1.0, kNan, std::numeric_limits<double>::infinity()}) {
    description.compliant_joints = {{"turn", false, bad}};
    expectContains(refusalOf(description), {"joint 'turn'", "above 0"});
  }
}

TEST(Instrument, RefusesABasePoseThatIsNotFinite) {
  expectContains(refusal([] { Instrument(armDescription(), arm(), translation(0, kNan, 0)); }),
                 {"instrument 'arm'", "base pose", "not finite"});
}

TEST(Instrument, RefusesUnknownLinks) {
  InstrumentDescription description = armDescription();
  description.tip_link = "tool0";
  expectContains(refusalOf(description), {"tip link 'tool0'", "base, rod, tip, finger"});
  description = armDescription();
  description.contact_links = {{"tool0", {}}};
  expectContains(refusalOf(description), {"contact link 'tool0'", "base, rod, tip, finger"});
  description.contact_links = {{"rod", {}}, {"rod", {}}};
  expectContains(refusalOf(description), {"contact link 'rod'", "twice"});
}

TEST(Instrument, MovingAndFixedUrdfsNeedTheirTopics) {
  InstrumentDescription description = armDescription();
  description.joint_state_topics.clear();
  expectContains(refusalOf(description), {"moving joints (slide, turn)", "joint_state_topics"});

  description.name = "table";
  description.tip_link = "top";
  const RobotModel table = parse("<link name=\"top\"/>");
  const Instrument obstacle(description, table, Pose::Identity());
  EXPECT_TRUE(obstacle.isObstacle());
  EXPECT_EQ(obstacle.initialPositions().size(), 0);
  description.joint_state_topics = {{"/joint_states"}};
  expectContains(refusal([&] { Instrument(description, table, Pose::Identity()); }),
                 {"instrument 'table'", "'/joint_states'", "no moving joint"});
}

TEST(ContactLinks, ShapesOfTheSceneComeFirst) {
  InstrumentDescription description = armDescription();
  description.contact_links = {{"rod", {{BoxGeometry{Vector3(4, 5, 6)}, translation(7, 8, 9)}}}};
  const Instrument instrument = make(description);
  ASSERT_EQ(instrument.contactLinks().size(), 1u);
  const ContactLink& link = instrument.contactLinks()[0];
  EXPECT_EQ(link.name, "rod");
  EXPECT_EQ(link.link, instrument.model().findLink("rod"));
  ASSERT_EQ(link.shapes.size(), 1u);
  EXPECT_EQ(std::get<BoxGeometry>(link.shapes[0].geometry).size_m, Vector3(4, 5, 6));
  expectSamePose(link.shapes[0].X_LS, translation(7, 8, 9), 0.0);
}

TEST(ContactLinks, ThenCollisionOfTheUrdfAllOfIt) {
  InstrumentDescription description = armDescription();
  description.contact_links = {{"rod", {}}};
  const Instrument instrument = make(description);
  const ContactLink& link = instrument.contactLinks()[0];
  ASSERT_EQ(link.shapes.size(), 2u);
  EXPECT_EQ(std::get<SphereGeometry>(link.shapes[0].geometry).radius_m, 0.25);
  expectSamePose(link.shapes[0].X_LS, translation(0, 0, 1), 0.0);
  EXPECT_EQ(std::get<CylinderGeometry>(link.shapes[1].geometry).length_m, 2.0);
}

TEST(ContactLinks, ThenVisualOfTheUrdf) {
  InstrumentDescription description = armDescription();
  description.contact_links = {{"tip", {}}};
  const Instrument instrument = make(description);
  const ContactLink& link = instrument.contactLinks()[0];
  ASSERT_EQ(link.shapes.size(), 1u);
  EXPECT_EQ(std::get<BoxGeometry>(link.shapes[0].geometry).size_m, Vector3(1, 2, 3));
}

TEST(ContactLinks, ALinkWithoutAnyShapeIsRefusedWithTheFix) {
  InstrumentDescription description = armDescription();
  description.contact_links = {{"finger", {}}};
  expectContains(refusalOf(description),
                 {"contact link 'finger'", "neither <collision> nor <visual>", "name its shapes in the scene"});
  description.contact_links[0].shapes = {{SphereGeometry{0.01}, Pose::Identity()}};
  EXPECT_NO_THROW(make(description));
}

TEST(ContactLinks, ABadShapeIsNamed) {
  InstrumentDescription description = armDescription();
  description.contact_links = {
      {"tip", {{SphereGeometry{0.01}, Pose::Identity()}, {SphereGeometry{kNan}, Pose::Identity()}}}};
  expectContains(refusalOf(description), {"contact link 'tip'", "shape of the scene number 2", "sphere radius is nan"});
}

TEST(ContactLinks, MeshesOfTheUrdfAreReadOnlyWhereTheyTouch) {
  const TemporaryDirectory directory;
  directory.write("good.stl", binaryStl());
  const auto link = [](const std::string& name, const std::string& mesh) {
    return "<link name=\"" + name + "\"><visual><geometry><mesh filename=\"" + mesh +
           "\" scale=\"0.1 0.1 0.1\"/></geometry></visual></link>";
  };
  const std::string file = directory.write(
      "a.urdf", robot(link("good", "good.stl") + link("bad", "missing.stl") + joint("j", "fixed", "good", "bad")));
  InstrumentDescription description;
  description.name = "tool";
  description.tip_link = "good";
  description.contact_links = {{"good", {}}};
  const Instrument instrument(description, loadUrdf(file, nullptr), Pose::Identity());
  ASSERT_NE(instrument.contactLinks()[0].shapes[0].mesh, nullptr);
  EXPECT_NEAR(enclosedVolume(*instrument.contactLinks()[0].shapes[0].mesh), 1e-3, 1e-12);

  description.contact_links = {{"bad", {}}};
  expectContains(refusal([&] { Instrument(description, loadUrdf(file, nullptr), Pose::Identity()); }),
                 {"instrument 'tool'", "contact link 'bad'", "<visual> of the URDF number 1",
                  directory.path("missing.stl"), "does not exist"});
}

}  // namespace instrument_test
}  // namespace tissue_contact
