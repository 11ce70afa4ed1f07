/// Scenes that parse but cannot be built: each message gives the scene's file, line and key path.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>

#include "support/refusal.h"
#include "support/replaced.h"
#include "support/temporary_directory.h"
#include "support/tissue_files.h"
#include "tissue_contact/mesh/mesh_description.h"
#include "tissue_contact/scene/load_scene.h"
#include "tissue_contact/simulation/joint_state_player.h"
#include "tissue_contact/simulation/scene.h"
#include "tissue_contact/simulation/simulator.h"

namespace tissue_contact {
namespace bad_scene_test {

/// Line numbers matter to the cases: keep them in step.
const char* const kScene = R"(tissues:
  - name: pad
    block:
      size_m: [0.1, 0.1, 0.04]
      cells: [2, 2, 1]
    material: {youngs_modulus_pa: 5000, poissons_ratio: 0.45, density_kg_per_m3: 1000}
    fibre_direction: [1, 0, 0]
    regions:
      - name: tumour
        where:
          - sphere: {center_m: [0, 0, 0.02], radius_m: 0.05}
    fixed:
      - plane: {point_m: [0, 0, 0], normal: [0, 0, 1]}
      - box: {min_m: [-1, -1, 0], max_m: [1, 1, 0]}
  - name: organ
    mesh:
      file: organ.vtk
    material: {youngs_modulus_pa: 2000, poissons_ratio: 0.3, density_kg_per_m3: 1000}
  - name: skin
    shell: {file: skin.obj, thickness_m: 0.001}
    material: {youngs_modulus_pa: 2000, poissons_ratio: 0.3, density_kg_per_m3: 1000}
instruments:
  - name: table
    urdf: table.urdf
    tip_link: plate
    contact_links: [plate]
  - name: probe
    urdf: probe.urdf
    base_pose:
      position_m: [0, 0, 1]
    joint_state_topics: [/probe]
    joint_names:
      lift_recorded: lift
    initial_joint_positions:
      lift: 0.1
    tip_link: tip
    contact_links:
      - tip
      - link: shaft
        shapes:
          - sphere: {radius_m: 0.001}
          - mesh: {file: ball.stl}
friction:
  - {instrument: probe, tissue: pad, static: 0.5}
  - instrument: probe
    tissue: pad
    region: tumour
    law: tensor
    static: [[0.5, 0], [0, 0.4]]
    kinetic: [[0.4, 0], [0, 0.3]]
    axis: fibre
solver:
  method: predictor_corrector
)";

const char* const kTable = R"(<robot name="table"><link name="plate"><collision><geometry><box size=".1 .1 .01"/>
</geometry></collision></link></robot>)";

const char* const kProbe = R"(<robot name="probe">
<link name="base"/><link name="shaft"/>
<link name="tip"><collision><geometry><sphere radius=".002"/></geometry></collision></link>
<joint name="lift" type="prismatic"><parent link="base"/><child link="shaft"/><axis xyz="0 0 1"/>
<limit lower="-1" upper="1" effort="1" velocity="1"/></joint>
<joint name="end" type="fixed"><parent link="shaft"/><child link="tip"/></joint></robot>)";

struct BadCase {
  const char* name;
  const char* from;               ///< what of the good scene is replaced
  const char* to;                 ///< by what
  const char* where;              ///< start of the message: line and key path
  const char* problem;            ///< text the message must hold
  const char* file = nullptr;     ///< a file that is spoilt as well
  const char* content = nullptr;  ///< by this
};

std::ostream& operator<<(std::ostream& out, const BadCase& bad) { return out << bad.name; }

class BadSceneTest : public testing::TestWithParam<BadCase> {
 protected:
  BadSceneTest() {
    write("table.urdf", kTable);
    write("probe.urdf", kProbe);
    write("organ.vtk", vtkTetrahedron());
    write("skin.obj", "v 0 0 0.5\nv 0.1 0 0.5\nv 0 0.1 0.5\nf 1 2 3\n");
    write("ball.stl", stlTetrahedron());
  }

  void write(const std::string& name, const std::string& text) const { directory_.write(name, text); }

  /// Builds the scene as node and replay do.
  void build(const std::string& yaml) const {
    Simulator simulator(parseScene(yaml, directory_.path("scene.yaml"), nullptr), SceneEnvironment());
    JointStatePlayer player(simulator);
  }

  TemporaryDirectory directory_;
};

TEST_P(BadSceneTest, IsRefusedWithItsPlace) {
  const BadCase& bad = GetParam();
  ASSERT_NO_THROW(build(kScene));
  if (bad.file != nullptr) write(bad.file, bad.content);
  const std::string message =
      refusal([&] { build(*bad.from == '\0' ? std::string(kScene) : replaced(kScene, bad.from, bad.to)); });
  EXPECT_EQ(message.find(directory_.path("scene.yaml") + ":" + bad.where + ": "), 0U) << message;
  expectContains(message, {bad.problem});
  EXPECT_EQ(message.find('\n'), std::string::npos) << message;
}

const BadCase kTissues[] = {
    {"RegionWithoutElements", "center_m: [0, 0, 0.02]", "center_m: [1, 0, 0]", "10: tissues[0].regions[0].where",
     "region 'tumour' holds no element's centroid"},
    {"FixedWithoutNodes", "min_m: [-1, -1, 0]", "min_m: [1, -1, 0]", "14: tissues[0].fixed[1]", "holds no node"},
    {"FrameWithoutTf", "    fibre_direction: [1, 0, 0]", "    pose: {tf_frame: base}\n    fibre_direction: [1, 0, 0]",
     "7: tissues[0].pose.tf_frame", "no tf is available"},
    {"MeshIsNoMesh", "", "", "17: tissues[1].mesh.file", "neither Gmsh", "organ.vtk", "x"},
    {"MeshIsEmpty", "", "", "17: tissues[1].mesh.file", "is empty", "organ.vtk", ""},
    {"MeshHasFlatElement", "", "", "17: tissues[1].mesh.file", "tetrahedron 0", "organ.vtk",
     "# vtk DataFile Version 2.0\nx\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 4 float\n0 0 0 1 0 0 0 1 0 1 1 0\n"
     "CELLS 1 5\n4 0 1 2 3\nCELL_TYPES 1\n10\n"},
    {"MeshHasHugeCount", "", "", "17: tissues[1].mesh.file", "2147483648", "organ.vtk",
     "# vtk DataFile Version 2.0\nx\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 2147483648 float\n0 0 0\n"},
    {"ShellIsNoMesh", "", "", "20: tissues[2].shell.file", "cannot be read", "skin.obj", "x"},
    {"ShellFoldsOnItself", "", "", "20: tissues[2].shell", "belongs to", "skin.obj",
     "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 0 -1 0\nv 0 0 1\nf 1 2 3\nf 2 1 4\nf 1 2 5\n"},
};
INSTANTIATE_TEST_SUITE_P(Tissues, BadSceneTest, testing::ValuesIn(kTissues), testing::PrintToStringParamName());

const BadCase kInstruments[] = {
    {"NoParameters", "    urdf: probe.urdf\n", "    robot_description: x\n", "28: instruments[1].robot_description",
     "no parameters are available"},
    {"NoUrdfAtAll", "    urdf: probe.urdf\n", "", "27: instruments[1].robot_description",
     "no parameters are available"},
    {"UrdfIsNoXml", "", "", "28: instruments[1].urdf", "probe.urdf", "probe.urdf", "x"},
    {"UrdfIsEmpty", "", "", "28: instruments[1].urdf", "is empty", "probe.urdf", ""},
    {"FrameWithoutTf", "position_m: [0, 0, 1]", "tf_frame: base", "30: instruments[1].base_pose.tf_frame",
     "no tf is available"},
    {"UnknownTip", "tip_link: tip", "tip_link: top", "36: instruments[1].tip_link", "tip link 'top' is not a link"},
    {"UnknownContactLink", "      - tip\n", "      - top\n", "38: instruments[1].contact_links[0]",
     "contact link 'top' is not a link"},
    {"LinkWithoutShape", "      - tip\n", "      - base\n", "38: instruments[1].contact_links[0]",
     "neither <collision> nor <visual>"},
    {"ShapeIsNoMesh", "", "", "42: instruments[1].contact_links[1].shapes[1]", "ball.stl", "ball.stl", "x"},
    {"ShapeIsOpen", "", "", "42: instruments[1].contact_links[1].shapes[1]", "open sheet", "ball.stl",
     "solid x\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n"
     "endsolid x\n"},
    {"UnknownJointName", "lift_recorded: lift", "lift_recorded: lifd", "33: instruments[1].joint_names.lift_recorded",
     "not an independent joint"},
    {"UnknownInitialJoint", "      lift: 0.1", "      lifd: 0.1", "35: instruments[1].initial_joint_positions.lifd",
     "not an independent joint"},
    {"UnknownCompliantJoint", "      lift: 0.1",
     "      lift: 0.1\n    compliant_joints: [{joint: lifd, stiffness_n_per_m: 1000}]",
     "36: instruments[1].compliant_joints[0].joint", "not an independent joint"},
    {"ComplianceOfTheOtherKind", "      lift: 0.1",
     "      lift: 0.1\n    compliant_joints: [{joint: lift, stiffness_n_m_per_rad: 1}]",
     "36: instruments[1].compliant_joints[0]", "joint 'lift' slides; give its stiffness_n_per_m"},
    {"MovesWithoutTopic", "    joint_state_topics: [/probe]\n", "", "27: instruments[1]",
     "name one in joint_state_topics"},
    {"TopicWithoutJoints", "    urdf: table.urdf\n", "    urdf: table.urdf\n    joint_state_topics: [/table]\n",
     "25: instruments[0].joint_state_topics", "no moving joint"},
};
INSTANTIATE_TEST_SUITE_P(Instruments, BadSceneTest, testing::ValuesIn(kInstruments), testing::PrintToStringParamName());

const BadCase kPairs[] = {
    {"TensorDrives", "kinetic: [[0.4, 0], [0, 0.3]]", "kinetic: [[-0.4, 0], [0, 0.3]]", "45: friction[1]",
     "drives sliding"},
    {"TensorBelowKinetic", "static: [[0.5, 0], [0, 0.4]]", "static: [[0.5, 0], [0, 0.2]]", "45: friction[1]",
     "kinetic"},
    {"MethodForIsotropicOnly", "method: predictor_corrector", "method: polyhedral", "48: friction[1].law",
     "handles isotropic friction only"},
    {"BudgetWithoutClock", "method: predictor_corrector", "time_budget_s: 0.001", "52: solver", "clock"},
};
INSTANTIATE_TEST_SUITE_P(Pairs, BadSceneTest, testing::ValuesIn(kPairs), testing::PrintToStringParamName());

/// A scene made by a program has no lines; messages still give the entry.
TEST(BadSceneWithoutFile, NamesTheEntry) {
  Scene scene;
  scene.tissues.resize(1);
  scene.tissues[0].name = "pad";
  scene.tissues[0].geometry = BlockDescription{{0.1, 0.1, 0.1}, {1, 1, 1}, {}};
  scene.tissues[0].material.youngs_modulus_pa = std::numeric_limits<double>::quiet_NaN();
  scene.tissues[0].material.density_kg_per_m3 = 1000.0;
  const std::string message = refusal([&] { Simulator(scene, SceneEnvironment()); });
  EXPECT_EQ(message.find("tissues[0].material: "), 0U) << message;
}

/// Nothing would ever move: found by the player, after the scene is built.
TEST(BadSceneWithoutFile, HasNoTopic) {
  const Scene scene = parseScene(
      "tissues:\n  - name: pad\n    block: {size_m: [1, 1, 1], cells: [1, 1, 1]}\n"
      "    material: {youngs_modulus_pa: 5000, poissons_ratio: 0.3, density_kg_per_m3: 1000}\ninstruments: []\n",
      "scene.yaml", nullptr);
  Simulator simulator(scene, SceneEnvironment());
  const std::string message = refusal([&] { JointStatePlayer player(simulator); });
  EXPECT_EQ(message.find("scene.yaml:5: instruments: no instrument has a joint-state topic"), 0U) << message;
}

}  // namespace bad_scene_test
}  // namespace tissue_contact
