#include "tissue_contact/instrument/parse_urdf.h"

#include <gtest/gtest.h>

#include <string>
#include <variant>

#include "instrument_fixture.h"

namespace tissue_contact {
namespace {

const std::string kTwoLinks =
    "<link name=\"a\"/><link name=\"b\"/>";  // NOLINT(bugprone-throwing-static-initialization)

std::string refusalOf(const std::string& xml) {
  return refusal([&] { parseUrdf(xml, "test.urdf", "", nullptr); });
}

TEST(MalformedUrdf, Empty) { expectContains(refusalOf(""), {"test.urdf", "empty"}); }

TEST(MalformedUrdf, NotXml) { expectContains(refusalOf("hello"), {"test.urdf", "urdfdom refuses"}); }

TEST(MalformedUrdf, NotARobot) { expectContains(refusalOf("<house name=\"r\"/>"), {"test.urdf", "robot"}); }

TEST(MalformedUrdf, UnclosedElementIsNamedWithItsLine) {
  expectContains(refusalOf("<robot name=\"r\">\n  <link name=\"a\">\n</robot>"),
                 {"test.urdf:3:", "</robot>", "<link> of line 2"});
  expectContains(refusalOf("<robot name=\"r\">\n <link name=\"a\"/>\n"), {"test.urdf:1:", "<robot>", "never closed"});
  expectContains(refusalOf("<robot name=\"r\"></robot></robot>"), {"test.urdf:1:", "closes nothing"});
}

TEST(MalformedUrdf, BrokenAttribute) {
  expectContains(refusalOf("<robot name=\"r\"><link name></link></robot>"), {"test.urdf", "urdfdom refuses"});
}

TEST(MalformedUrdf, ZeroByte) {
  expectContains(refusalOf(robot("\n<link name=\"a\"/>") + std::string(1, '\0')), {"test.urdf:2:", "zero byte"});
}

TEST(MalformedUrdf, NoName) { expectContains(refusalOf("<robot><link name=\"a\"/></robot>"), {"test.urdf", "name"}); }

TEST(MalformedUrdf, NoLink) { expectContains(refusalOf(robot("")), {"test.urdf", "No link"}); }

TEST(MalformedUrdf, EmptyNames) {
  expectContains(refusalOf(robot("<link name=\"\"/>")), {"test.urdf", "link", "empty name"});
  expectContains(refusalOf(robot("<link/>")), {"test.urdf", "No name given for the link"});
  expectContains(refusalOf(robot(kTwoLinks + joint("", "fixed", "a", "b"))), {"test.urdf", "link 'b'", "empty name"});
}

TEST(MalformedUrdf, DuplicateLink) {
  expectContains(refusalOf(robot("<link name=\"a\"/><link name=\"a\"/>")), {"test.urdf", "'a'", "not unique"});
}

TEST(MalformedUrdf, DuplicateJoint) {
  expectContains(refusalOf(robot(kTwoLinks + "<link name=\"c\"/>" + joint("j", "fixed", "a", "b") +
                                 joint("j", "fixed", "a", "c"))),
                 {"test.urdf", "'j'", "not unique"});
}

TEST(MalformedUrdf, UnknownChildLink) {
  expectContains(refusalOf(robot(kTwoLinks + joint("j", "fixed", "a", "nowhere"))), {"test.urdf", "nowhere", "j"});
}

TEST(MalformedUrdf, UnknownParentLink) {
  expectContains(refusalOf(robot(kTwoLinks + joint("j", "fixed", "nowhere", "b"))), {"test.urdf", "nowhere", "j"});
}

TEST(MalformedUrdf, TwoRoots) { expectContains(refusalOf(robot(kTwoLinks)), {"test.urdf", "root", "a", "b"}); }

TEST(MalformedUrdf, NoRoot) {
  expectContains(refusalOf(robot(kTwoLinks + joint("ab", "fixed", "a", "b") + joint("ba", "fixed", "b", "a"))),
                 {"test.urdf", "No root link"});
}

TEST(MalformedUrdf, RingApartFromTheRoot) {
  expectContains(refusalOf(robot("<link name=\"root\"/>" + kTwoLinks + joint("ab", "fixed", "a", "b") +
                                 joint("ba", "fixed", "b", "a"))),
                 {"test.urdf", "link 'a'", "not connected to the root 'root'"});
}

TEST(MalformedUrdf, LinkWithTwoParents) {
  expectContains(refusalOf(robot(kTwoLinks + "<link name=\"c\"/>" + joint("ab", "fixed", "a", "b") +
                                 joint("ac", "fixed", "a", "c") + joint("bc", "fixed", "b", "c"))),
                 {"test.urdf", "link 'c'", "'ac'", "'bc'", "one parent"});
}

TEST(MalformedUrdf, UnsupportedJointTypes) {
  expectContains(refusalOf(robot(kTwoLinks + joint("j", "planar", "a", "b"))),
                 {"test.urdf", "joint 'j'", "planar", "use fixed, revolute, continuous or prismatic"});
  expectContains(refusalOf(robot(kTwoLinks + joint("j", "floating", "a", "b"))),
                 {"test.urdf", "joint 'j'", "floating", "use fixed, revolute, continuous or prismatic"});
  expectContains(refusalOf(robot(kTwoLinks + joint("j", "screw", "a", "b"))), {"test.urdf", "[j]", "screw"});
}

TEST(MalformedUrdf, MissingLimits) {
  expectContains(refusalOf(robot(kTwoLinks + "<joint name=\"j\" type=\"revolute\"><parent link=\"a\"/><child "
                                             "link=\"b\"/></joint>")),
                 {"test.urdf", "[j]", "limits"});
}

TEST(MalformedUrdf, ZeroAxis) {
  expectContains(refusalOf(robot(kTwoLinks + joint("j", "revolute", "a", "b", "<axis xyz=\"0 0 0\"/>"))),
                 {"test.urdf", "joint 'j'", "zero <axis>", "0 0 1"});
}

TEST(MalformedUrdf, TinyAxisIsADirection) {
  const RobotModel model = parse(kTwoLinks + joint("j", "revolute", "a", "b", "<axis xyz=\"0 1e-200 0\"/>"));
  EXPECT_EQ(model.links()[1].axis, Vector3::UnitY());
}

TEST(MalformedUrdf, NumbersThatAreNotFinite) {
  const auto refusalOfJoint = [](const std::string& element) {
    return refusalOf(robot(kTwoLinks + joint("j", "revolute", "a", "b", element)));
  };
  for (const std::string bad : {"nan", "inf", "-inf", "1e999", "0,5", "x"}) {
    SCOPED_TRACE(bad);
    const std::string vector = "\"0 1 " + bad + "\"/>";
    expectContains(refusalOfJoint("<origin xyz=" + vector), {"test.urdf", "[j]", bad});
    expectContains(refusalOfJoint("<origin rpy=" + vector), {"test.urdf", "[j]", bad});
    expectContains(refusalOfJoint("<axis xyz=" + vector), {"test.urdf", "[j]", bad});
    expectContains(refusalOf(robot("<link name=\"a\"><collision><origin xyz=\"" + bad +
                                   " 0 0\"/><geometry><sphere radius=\"1\"/></geometry></collision></link>")),
                   {"test.urdf", bad, "a"});
    expectContains(refusalOf(robot("<link name=\"a\"><collision><geometry><sphere radius=\"" + bad +
                                   "\"/></geometry></collision></link>")),
                   {"test.urdf", bad, "a"});
  }
}

TEST(MalformedUrdf, MimicOfAnUnknownJoint) {
  expectContains(refusalOf(robot(kTwoLinks + joint("j", "revolute", "a", "b", "<mimic joint=\"ghost\"/>"))),
                 {"test.urdf", "joint 'j'", "unknown joint 'ghost'"});
}

TEST(MalformedUrdf, MimicOfAFixedJoint) {
  expectContains(refusalOf(robot(kTwoLinks + "<link name=\"c\"/>" + joint("still", "fixed", "a", "b") +
                                 joint("j", "revolute", "b", "c", "<mimic joint=\"still\"/>"))),
                 {"test.urdf", "joint 'j'", "'still'", "fixed"});
}

TEST(MalformedUrdf, MimicCycles) {
  expectContains(refusalOf(robot(kTwoLinks + joint("j", "revolute", "a", "b", "<mimic joint=\"j\"/>"))),
                 {"test.urdf", "joint 'j'", "cycle"});
  expectContains(
      refusalOf(robot(kTwoLinks + "<link name=\"c\"/>" + joint("j", "revolute", "a", "b", "<mimic joint=\"k\"/>") +
                      joint("k", "revolute", "b", "c", "<mimic joint=\"j\"/>"))),
      {"test.urdf", "cycle"});
}

TEST(MalformedUrdf, MimicNumbers) {
  const std::string start = kTwoLinks + "<link name=\"c\"/><link name=\"d\"/>" + joint("drive", "revolute", "a", "b");
  expectContains(refusalOf(robot(start + joint("j", "revolute", "b", "c", "<mimic joint=\"drive\" offset=\"nan\"/>"))),
                 {"test.urdf", "[j]", "nan"});
  // Each number is finite, their product is not.
  expectContains(
      refusalOf(robot(start + joint("j", "revolute", "b", "c", "<mimic joint=\"drive\" multiplier=\"1e200\"/>") +
                      joint("k", "revolute", "c", "d", "<mimic joint=\"j\" multiplier=\"1e200\"/>"))),
      {"test.urdf", "joint 'k'", "not finite"});
}

TEST(MalformedUrdf, UndefinedGeometry) {
  expectContains(refusalOf(robot("<link name=\"a\"><collision><geometry><torus/></geometry></collision></link>")),
                 {"test.urdf", "torus", "a"});
}

TEST(MalformedUrdf, APartThatUrdfdomWouldDropSilently) {
  // The collision shape is fine; urdfdom stops reading the link at the inertia and only logs that.
  expectContains(
      refusalOf(robot("<link name=\"a\"><inertial><mass value=\"1\"/></inertial><collision><geometry><sphere "
                      "radius=\"1\"/></geometry></collision></link>")),
      {"test.urdf", "inertia", "[a]"});
}

TEST(ParseUrdf, AMalformedColourCostsNothing) {
  EXPECT_NO_THROW(parse("<material name=\"m\"><color rgba=\"red\"/></material><link name=\"a\"/>"));
}

TEST(HostileUrdf, DeepNestingDoesNotOverflowTheStack) {
  std::string deep;
  for (int i = 0; i < 200000; ++i) deep += "<a>";
  for (int i = 0; i < 200000; ++i) deep += "</a>";
  expectContains(refusalOf(robot(deep)), {"test.urdf:1:", "<a>", "nested more than 64"});
}

TEST(HostileUrdf, TooManyLinks) {
  std::string many;
  for (int i = 0; i < 10001; ++i) many += "<link name=\"l" + std::to_string(i) + "\"/>";
  expectContains(refusalOf(robot(many)), {"test.urdf", "10001 links", "at most 10000"});
}

TEST(HostileUrdf, TooLong) {
  expectContains(refusalOf(robot(std::string(17 << 20, ' '))), {"test.urdf", "at most 16777216"});
}

TEST(HostileUrdf, LongChainsAreHandled) {
  std::string chain = "<link name=\"l5000\"/>";
  std::string previous = "drive";
  for (int i = 4999; i >= 0; --i) {
    const std::string name = "l" + std::to_string(i);
    const std::string mimic = i == 4999 ? "" : "<mimic joint=\"j" + std::to_string(i + 1) + "\"/>";
    chain += "<link name=\"" + name + "\"/>" +
             joint("j" + std::to_string(i), "prismatic", "l" + std::to_string(i + 1), name, mimic);
  }
  const RobotModel model = parse(chain);
  ASSERT_EQ(model.joints().size(), 1u);
  std::vector<Pose> X_BL;
  model.forwardKinematics(VectorX::Ones(1), X_BL);
  expectSamePose(X_BL.back(), translation(5000, 0, 0), 1e-9);
}

TEST(ParseUrdf, NothingIsPrinted) {
  testing::internal::CaptureStderr();
  testing::internal::CaptureStdout();
  refusalOf(robot(kTwoLinks + joint("j", "screw", "a", "b")));
  EXPECT_EQ(testing::internal::GetCapturedStderr(), "");
  EXPECT_EQ(testing::internal::GetCapturedStdout(), "");
}

TEST(ParseUrdf, CommentsAndCdataAreNoElements) {
  EXPECT_NO_THROW(
      parse("<!-- <link name=\"c\"> --><link name=\"a\"/><!-- > -- </x> --><gazebo><![CDATA[<a>]]></gazebo>"));
  EXPECT_NO_THROW(parseUrdf("<?xml version=\"1.0\"?>" + robot("<link name='a>b'/>"), "test.urdf", "", nullptr));
}

TEST(ParseUrdf, ReadsEveryShape) {
  const RobotModel model = parseUrdf(
      robot(
          "<link name=\"a\">"
          "<collision><origin xyz=\"1 2 3\" rpy=\"0 0 0.5\"/><geometry><sphere radius=\"0.25\"/></geometry></collision>"
          "<collision><geometry><box size=\"1 2 3\"/></geometry></collision>"
          "<collision><geometry><cylinder radius=\"0.5\" length=\"2\"/></geometry></collision>"
          "<visual><geometry><mesh filename=\"meshes/a.stl\" scale=\"1 2 -3\"/></geometry></visual>"
          "<visual><geometry><mesh filename=\"package://tools/b.obj\"/></geometry></visual></link>"),
      "test.urdf", "/base", [](const std::string& package) { return package == "tools" ? "/opt/tools" : ""; });
  const LinkGeometry& geometry = model.links()[0].geometry;
  ASSERT_EQ(geometry.collision.size(), 3u);
  ASSERT_EQ(geometry.visual.size(), 2u);
  EXPECT_EQ(std::get<SphereGeometry>(geometry.collision[0].geometry).radius_m, 0.25);
  expectSamePose(geometry.collision[0].X_LS, translation(1, 2, 3) * rotation(0.5, Vector3::UnitZ()), 1e-15);
  EXPECT_EQ(std::get<BoxGeometry>(geometry.collision[1].geometry).size_m, Vector3(1, 2, 3));
  EXPECT_EQ(std::get<CylinderGeometry>(geometry.collision[2].geometry).radius_m, 0.5);
  EXPECT_EQ(std::get<CylinderGeometry>(geometry.collision[2].geometry).length_m, 2.0);
  EXPECT_EQ(std::get<MeshGeometry>(geometry.visual[0].geometry).file, "/base/meshes/a.stl");
  EXPECT_EQ(std::get<MeshGeometry>(geometry.visual[0].geometry).scale, Vector3(1, 2, -3));
  EXPECT_EQ(std::get<MeshGeometry>(geometry.visual[1].geometry).file, "/opt/tools/b.obj");
  EXPECT_EQ(std::get<MeshGeometry>(geometry.visual[1].geometry).scale, Vector3::Ones());
}

TEST(ParseUrdf, MeshesThatCannotBePlacedAreKeptAsWritten) {
  const RobotModel model = parse(
      "<link name=\"a\"><visual><geometry><mesh filename=\"package://ghost/a.stl\"/></geometry></visual>"
      "<visual><geometry><mesh filename=\"a.stl\"/></geometry></visual></link>");
  EXPECT_EQ(std::get<MeshGeometry>(model.links()[0].geometry.visual[0].geometry).file, "package://ghost/a.stl");
  EXPECT_EQ(std::get<MeshGeometry>(model.links()[0].geometry.visual[1].geometry).file, "a.stl");
}

TEST(ParseUrdf, XacroIsCalledThatUnlessItIsInAComment) {
  const std::string macro = "<xacro:property name=\"r\" value=\"0.1\"/>";
  expectContains(refusal([&] { parse("<link name=\"a\"/>" + macro); }),
                 {"xacro FILE.urdf.xacro >", "robot_description"});
  EXPECT_EQ(parse("<!-- " + macro + " --><link name=\"a\"/>").links().size(), 1u);
}

TEST(LoadUrdf, RelativeMeshesAreBesideTheFile) {
  const TemporaryDirectory directory;
  const std::string file = directory.write(
      "a.urdf", robot("<link name=\"a\"><visual><geometry><mesh filename=\"m/a.stl\"/></geometry></visual></link>"));
  const RobotModel model = loadUrdf(file, nullptr);
  EXPECT_EQ(std::get<MeshGeometry>(model.links()[0].geometry.visual[0].geometry).file, directory.path("m/a.stl"));
}

TEST(LoadUrdf, UnreadableFiles) {
  const TemporaryDirectory directory;
  expectContains(refusal([&] { loadUrdf(directory.path("none.urdf"), nullptr); }), {"none.urdf", "does not exist"});
  expectContains(refusal([&] { loadUrdf(directory.path(""), nullptr); }), {"not a regular file"});
  expectContains(refusal([&] { loadUrdf(directory.write("empty.urdf", ""), nullptr); }), {"empty.urdf", "is empty"});
  const std::string bad = directory.write("bad.urdf", "<robot>\n<link></robot>");
  expectContains(refusal([&] { loadUrdf(bad, nullptr); }), {bad + ":2:", "</robot>"});
}

}  // namespace
}  // namespace tissue_contact
