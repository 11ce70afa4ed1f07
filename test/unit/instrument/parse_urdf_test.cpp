#include "tissue_contact/instrument/parse_urdf.h"

#include <gtest/gtest.h>

#include <string>
#include <variant>

#include "instrument_fixture.h"

namespace tissue_contact {
namespace parse_urdf_test {

const std::string kTwoLinks =
    "<link name=\"a\"/><link name=\"b\"/>";  // NOLINT(bugprone-throwing-static-initialization)

std::string refusalOf(const std::string& xml) {
  return refusal([&] { parseUrdf(xml, "test.urdf", "", nullptr); });
}

struct Malformed {
  const char* name;
  std::string xml;
  std::vector<std::string> words;  ///< of the refusal, beside the name of the file
};

class MalformedUrdf : public testing::TestWithParam<Malformed> {};

TEST_P(MalformedUrdf, IsRefusedInWords) {
  const std::string message = refusalOf(GetParam().xml);
  expectContains(message, {"test.urdf"});
  expectContains(message, GetParam().words);
}

std::string nameOf(const testing::TestParamInfo<Malformed>& info) { return info.param.name; }

const Malformed kTexts[] = {
    {"Empty", "", {"empty"}},
    {"NotXml", "hello", {"urdfdom refuses"}},
    {"NotARobot",
     "<?xml version=\"1.0\"?><!-- <robot> --><sdf version=\"1.6\"/>",
     {"outermost element is <sdf>", "<robot>", "SDF"}},
    {"NumbersOnSeveralLines",
     robot(kTwoLinks +
           "<joint name=\"j\" type=\"fixed\"><origin xyz=\" 0\n 0\"/><parent link=\"a\"/><child link=\"b\"/></joint>"),
     {"urdfdom refuses", "[0?]"}},
    {"TwoShapes",
     robot("<link name=\"a\">\n<collision><geometry><sphere radius=\"0.01\"/>\n<box size=\"1 1 "
           "1\"/></geometry></collision></link>"),
     {"test.urdf:3:", "second shape in a <geometry>", "<collision> of its own"}},
    {"LinkInALink",
     robot("<link name=\"a\">\n<link name=\"b\"/></link>"),
     {"test.urdf:2:", "a <link> within a <link>", "move it out"}},
    {"UnclosedElement",
     "<robot name=\"r\">\n  <link name=\"a\">\n</robot>",
     {"test.urdf:3:", "</robot>", "<link> of line 2"}},
    {"NeverClosed", "<robot name=\"r\">\n <link name=\"a\"/>\n", {"test.urdf:1:", "<robot>", "never closed"}},
    {"ClosesNothing", "<robot name=\"r\"></robot></robot>", {"test.urdf:1:", "closes nothing"}},
    {"BrokenAttribute", "<robot name=\"r\"><link name></link></robot>", {"urdfdom refuses"}},
    {"ZeroByte", robot("\n<link name=\"a\"/>") + std::string(1, '\0'), {"test.urdf:2:", "zero byte"}},
};
INSTANTIATE_TEST_SUITE_P(Texts, MalformedUrdf, testing::ValuesIn(kTexts), nameOf);

const std::string kC = "<link name=\"c\"/>";

const Malformed kTrees[] = {
    {"NoName", "<robot><link name=\"a\"/></robot>", {"name"}},
    {"NoLink", robot(""), {"No link"}},
    {"EmptyNameOfALink", robot("<link name=\"\"/>"), {"link", "empty name"}},
    {"NoNameOfALink", robot("<link/>"), {"No name given for the link"}},
    {"EmptyNameOfAJoint", robot(kTwoLinks + joint("", "fixed", "a", "b")), {"link 'b'", "empty name"}},
    {"DuplicateLink", robot("<link name=\"a\"/><link name=\"a\"/>"), {"'a'", "not unique"}},
    {"DuplicateJoint",
     robot(kTwoLinks + kC + joint("j", "fixed", "a", "b") + joint("j", "fixed", "a", "c")),
     {"'j'", "not unique"}},
    {"UnknownChildLink", robot(kTwoLinks + joint("j", "fixed", "a", "nowhere")), {"nowhere", "j"}},
    {"UnknownParentLink", robot(kTwoLinks + joint("j", "fixed", "nowhere", "b")), {"nowhere", "j"}},
    {"TwoRoots", robot(kTwoLinks), {"root", "a", "b"}},
    {"NoRoot", robot(kTwoLinks + joint("ab", "fixed", "a", "b") + joint("ba", "fixed", "b", "a")), {"No root link"}},
    {"RingApartFromTheRoot",
     robot("<link name=\"root\"/>" + kTwoLinks + joint("ab", "fixed", "a", "b") + joint("ba", "fixed", "b", "a")),
     {"link 'a'", "not connected to the root 'root'"}},
    {"LinkWithTwoParents",
     robot(kTwoLinks + kC + joint("ab", "fixed", "a", "b") + joint("ac", "fixed", "a", "c") +
           joint("bc", "fixed", "b", "c")),
     {"link 'c'", "'ac'", "'bc'", "one parent"}},
};
INSTANTIATE_TEST_SUITE_P(Trees, MalformedUrdf, testing::ValuesIn(kTrees), nameOf);

const std::string kDriven = kTwoLinks + kC + "<link name=\"d\"/>" + joint("drive", "revolute", "a", "b");

const Malformed kJoints[] = {
    {"Planar",
     robot(kTwoLinks + joint("j", "planar", "a", "b")),
     {"joint 'j'", "planar", "use fixed, revolute, continuous or prismatic"}},
    {"Floating",
     robot(kTwoLinks + joint("j", "floating", "a", "b")),
     {"joint 'j'", "floating", "use fixed, revolute, continuous or prismatic", "tf_frame"}},
    {"UnknownType",
     robot(kTwoLinks + joint("j", "screw", "a", "b")),
     {"[j]", "screw", "fixed, revolute, continuous or prismatic"}},
    {"MissingLimits",
     robot(kTwoLinks + "<joint name=\"j\" type=\"revolute\"><parent link=\"a\"/><child link=\"b\"/></joint>"),
     {"[j]", "limits"}},
    {"ZeroAxis",
     robot(kTwoLinks + joint("j", "revolute", "a", "b", "<axis xyz=\"0 0 0\"/>")),
     {"joint 'j'", "zero <axis>", "0 0 1"}},
    {"MimicOfAnUnknownJoint",
     robot(kTwoLinks + joint("j", "revolute", "a", "b", "<mimic joint=\"ghost\"/>")),
     {"joint 'j'", "unknown joint 'ghost'"}},
    {"MimicOfAFixedJoint",
     robot(kTwoLinks + kC + joint("still", "fixed", "a", "b") +
           joint("j", "revolute", "b", "c", "<mimic joint=\"still\"/>")),
     {"joint 'j'", "'still'", "fixed"}},
    {"MimicOfItself",
     robot(kTwoLinks + joint("j", "revolute", "a", "b", "<mimic joint=\"j\"/>")),
     {"joint 'j'", "cycle"}},
    {"MimicsInACycle",
     robot(kTwoLinks + kC + joint("j", "revolute", "a", "b", "<mimic joint=\"k\"/>") +
           joint("k", "revolute", "b", "c", "<mimic joint=\"j\"/>")),
     {"cycle"}},
    {"MimicOffsetNan",
     robot(kDriven + joint("j", "revolute", "b", "c", "<mimic joint=\"drive\" offset=\"nan\"/>")),
     {"[j]", "nan"}},
    // Each number is finite, their product is not.
    {"MimicProductOverflows",
     robot(kDriven + joint("j", "revolute", "b", "c", "<mimic joint=\"drive\" multiplier=\"1e200\"/>") +
           joint("k", "revolute", "c", "d", "<mimic joint=\"j\" multiplier=\"1e200\"/>")),
     {"joint 'k'", "not finite"}},
};
INSTANTIATE_TEST_SUITE_P(Joints, MalformedUrdf, testing::ValuesIn(kJoints), nameOf);

const Malformed kGeometries[] = {
    {"Undefined",
     robot("<link name=\"a\"><collision><geometry><torus/></geometry></collision></link>"),
     {"torus", "a", "correct or delete"}},
    // The collision shape is fine; urdfdom stops reading the link at the inertia and only logs that.
    {"BehindAPartThatUrdfdomDrops",
     robot("<link name=\"a\"><inertial><mass value=\"1\"/></inertial><collision><geometry><sphere radius=\"1\"/>"
           "</geometry></collision></link>"),
     {"inertia", "[a]"}},
};
INSTANTIATE_TEST_SUITE_P(Geometries, MalformedUrdf, testing::ValuesIn(kGeometries), nameOf);

TEST(ParseUrdf, ATinyAxisIsADirection) {
  const RobotModel model = parse(kTwoLinks + joint("j", "revolute", "a", "b", "<axis xyz=\"0 1e-200 0\"/>"));
  EXPECT_EQ(model.links()[1].axis, Vector3::UnitY());
}

TEST(ParseUrdf, RefusesNumbersThatAreNotFinite) {
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

// What others write beside a shape, or where urdfdom does not look, is no second shape.
TEST(ParseUrdf, OtherElementsBesideAShapeAreLeftAlone) {
  const std::string shape = "<geometry><sphere radius=\"0.01\"/><verbose/></geometry>";
  const std::string two = "<geometry><sphere radius=\"0.01\"/><box size=\"1 1 1\"/></geometry>";
  EXPECT_NO_THROW(parse("<link name=\"a\"><collision>" + shape + "</collision></link>"));
  EXPECT_NO_THROW(parse("<link name=\"a\"/><gazebo><collision>" + two + "</collision></gazebo>"));
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

// To find one took .3 s among some hundred: a robot of 300 meshes started after minutes.
TEST(ParseUrdf, APackageIsLookedForOnce) {
  std::string link = "<link name=\"a\">";
  for (const char* uri :
       {"package://tools/a.stl", "package://ghost/a.stl", "package://tools/b.stl", "package://ghost/b.stl"})
    link += "<visual><geometry><mesh filename=\"" + std::string(uri) + "\"/></geometry></visual>";
  std::vector<std::string> asked;
  const RobotModel model = parseUrdf(robot(link + "</link>"), "test.urdf", "/base", [&](const std::string& package) {
    asked.push_back(package);
    return package == "tools" ? "/opt/tools" : "";
  });
  EXPECT_EQ(asked, (std::vector<std::string>{"tools", "ghost"}));
  const std::vector<ShapeDescription>& visual = model.links()[0].geometry.visual;
  EXPECT_EQ(std::get<MeshGeometry>(visual[2].geometry).file, "/opt/tools/b.stl");
  EXPECT_EQ(std::get<MeshGeometry>(visual[3].geometry).file, "package://ghost/b.stl");
}

TEST(ParseUrdf, MeshesThatCannotBePlacedAreKeptAsWritten) {
  const RobotModel model = parse(
      "<link name=\"a\"><visual><geometry><mesh filename=\"package://ghost/a.stl\"/></geometry></visual>"
      "<visual><geometry><mesh filename=\"a.stl\"/></geometry></visual></link>");
  EXPECT_EQ(std::get<MeshGeometry>(model.links()[0].geometry.visual[0].geometry).file, "package://ghost/a.stl");
  EXPECT_EQ(std::get<MeshGeometry>(model.links()[0].geometry.visual[1].geometry).file, "a.stl");
}

// urdfdom 3 leaves quaternions out and takes degrees for what they are: a tool that lies across without a word.
TEST(ParseUrdf, RotationsThatWouldBeOthersAreRefused) {
  const auto shape = [](const std::string& origin) {
    return "<link name=\"a\"><collision>" + origin + "<geometry><sphere radius=\"0.1\"/></geometry></collision></link>";
  };
  const auto hinge = [](const std::string& origin) {
    return "<link name=\"a\"/><link name=\"b\"/>" + joint("j", "revolute", "a", "b", origin);
  };
  for (const char* name : {"quat_xyzw", "quat", "wxyz", "quaternion"}) {
    const std::string origin = "<origin xyz=\"0 0 1\" " + std::string(name) + "=\"0 0.7 0 0.7\"/>";
    expectContains(refusal([&] { parse(shape(origin)); }),
                   {"test.urdf:1: <origin>", name, "rpy=\"roll pitch yaw\", in rad"});
    expectContains(refusal([&] { parse(hinge(origin)); }), {name, "would be left out"});
  }
  expectContains(refusal([&] { parse(shape("<origin rpy='0 90 0'/>")); }),
                 {"<origin> has rpy=\"0 90", "radians, not degrees"});
  expectContains(refusal([&] { parse(hinge("\n<origin\nxyz = \"0 0 0\"\nrpy =\n\"0 0 -45\"/>")); }),
                 {"test.urdf:2: <origin>", "-45"});
  EXPECT_EQ(parse(shape("<origin rpy=\"9.4248 0 -6.2832\"/>")).links().size(), 1u) << "sums of quarters";
  EXPECT_EQ(parse("<link name=\"a\"><inertial><origin rpy=\"0 90 0\"/><mass value=\"1\"/><inertia ixx=\"1\" ixy=\"0\" "
                  "ixz=\"0\" "
                  "iyy=\"1\" iyz=\"0\" izz=\"1\"/></inertial></link>")
                .links()
                .size(),
            1u)
      << "masses place nothing";
  EXPECT_EQ(parse("<!-- " + shape("<origin rpy=\"0 90 0\"/>") + " --><link name=\"a\"/>").links().size(), 1u);
}

TEST(ParseUrdf, XacroIsCalledThatUnlessItIsInAComment) {
  const std::string macro = "<xacro:property name=\"r\" value=\"0.1\"/>";
  expectContains(refusal([&] { parse("<link name=\"a\"/>" + macro); }),
                 {"xacro FILE.urdf.xacro >", "robot_description"});
  EXPECT_EQ(parse("<!-- " + macro + " --><link name=\"a\"/>").links().size(), 1u);
  // The oldest xacro files have no such element; their names would become those of links.
  expectContains(refusal([&] { parse("<link name=\"${prefix}a\"/>"); }), {"xacro FILE.urdf.xacro >"});
  expectContains(refusal([&] { parse("<link name=\"$(arg prefix)a\"/>"); }), {"xacro FILE.urdf.xacro >"});
  // What may be left in one that is expanded: robot_state_publisher's PR2 calls a macro for Gazebo that nothing defines.
  EXPECT_NO_THROW(parse("<link name=\"a\"/><xacro:head_gazebo name=\"head_pan\"/>"));
  EXPECT_NO_THROW(parse("<link name=\"a\"/><gazebo><plugin filename=\"${HOME}/p.so\"/></gazebo><gazebo/>"));
  EXPECT_THROW(parse("<gazebo></gazebo><link name=\"${prefix}a\"/>"), std::invalid_argument);
  EXPECT_EQ(parse("<!-- <link name=\"${prefix}b\"/> --><link name=\"a\"/>").links().size(), 1u);
  EXPECT_EQ(parse("<link name=\"a\"/><gazebo>${x}</gazebo>").links().size(), 1u);
}

TEST(ParseUrdf, TellsWhichNamesAreMimics) {
  const RobotModel model =
      parse("<link name=\"a\"/><link name=\"b\"/><link name=\"c\"/>" + joint("drive", "revolute", "a", "b") +
            joint("j", "revolute", "b", "c", "<mimic joint=\"drive\" multiplier=\"0.5\"/>"));
  EXPECT_EQ(model.mimicsText({"elbow", "j"}),
            "mimics, which only follow a joint: j of drive; give that joint's position");
  EXPECT_EQ(model.mimicsText({"drive", "elbow", ""}), "");
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

}  // namespace parse_urdf_test
}  // namespace tissue_contact
