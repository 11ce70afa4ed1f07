/// What is refused, and that each message gives file, line and key path. Each case spoils one place of a good scene.
#include <chrono>
#include <initializer_list>

#include "scene_fixture.h"

namespace tissue_contact {
namespace bad_scene_test {

class BadSceneTest : public SceneTest, public testing::WithParamInterface<BadScene> {};

TEST_P(BadSceneTest, IsRefusedWithItsPlace) { expectRefused(kFullScene, GetParam()); }

const BadScene kKeys[] = {
    {"world_frame: lab", "word_frame: lab", "1: word_frame", "unknown key; did you mean \"world_frame\"?"},
    {"youngs_modulus_pa: 5e3", "youngs_modulus: 5e3", "17: tissues[0].material.youngs_modulus",
     "did you mean \"youngs_modulus_pa\"? allowed here: preset, model, dilatation, distortion, youngs_modulus_pa, "
     "poissons_ratio, "
     "density_kg_per_m3"},
    {"  tf: true", "  tff: true", "73: publish.tff", "unknown key; did you mean \"tf\"?"},
    {"  contact_passes: 3", "  zzz: 3", "66: solver.zzz", "unknown key; allowed here: method, relaxation, iterations"},
    {"  iterations: 20", "  iterations: 20\n  iterations: 30", "66: solver.iterations",
     "given twice (first in line 65)"},
    {"      outer_pitch: pitch", "      outer_yaw: pitch", "42: instruments[0].joint_names.outer_yaw", "given twice"},
    {"      stiffness_s: 0.002", "      ? [1, 2]\n      : 0.002", "22: tissues[0].damping", "key that is not text"},
    {"      density_kg_per_m3: 1060\n", "", "15: tissues[0].material", "required key \"density_kg_per_m3\" is missing"},
    {"    tip_link: tip\n    contact_links: [jaw]", "    contact_links: [jaw]", "56: instruments[1]",
     "required key \"tip_link\" is missing"},
    {"    urdf: package://tissue_contact/arm.urdf",
     "    urdf: package://tissue_contact/arm.urdf\n    robot_description: x", "37: instruments[0].robot_description",
     "cannot be given together with \"urdf\""},
    {"      rpy_rad: [0.1, 0.2, 0.3]", "      rpy_rad: [0.1, 0.2, 0.3]\n      quaternion_xyzw: [0, 0, 0, 1]",
     "15: tissues[0].pose.quaternion_xyzw", "cannot be given together"},
    {"{growth: 1.5}", "{fine_at: center}", "10: tissues[0].block.grading.y", "required key \"growth\" is missing"},
    {"      - sphere: {center_m: [0.1, 0.2, 0.3], radius_m: 0.05}", "      - {}", "26: tissues[0].fixed[2]",
     "none of box, plane, sphere, group, cell_data is given"},
    {"pose: {position_m: [0, 0, 0.005], rpy_rad: [0, 0, 1.5]}", "pose: {tf_frame: x}",
     "52: instruments[0].contact_links[1].shapes[1].pose.tf_frame", "unknown key"},
    {"    damping:", "    \"damp\\ning\":", "20: tissues[0].damp?ing", "did you mean \"damping\"?"},
};
INSTANTIATE_TEST_SUITE_P(Keys, BadSceneTest, testing::ValuesIn(kKeys));

const BadScene kTypes[] = {
    {"[0.1, 0.2, -9.81]", "9.81", "2: gravity_m_per_s2", "is \"9.81\"; it must be a list of 3 numbers"},
    {"[0.1, 0.2, -9.81]", "[0, 9.81]", "2: gravity_m_per_s2", "has 2 elements; it must be a list of 3 numbers"},
    {"[0.1, 0.2, -9.81]", "[0, 0, down]", "2: gravity_m_per_s2[2]", "is \"down\"; it must be a number"},
    {"mass_per_s: 0.5", "mass_per_s: \"0.5\"", "21: tissues[0].damping.mass_per_s", "is the text \"0.5\""},
    {"mass_per_s: 0.5", "mass_per_s: !!str 0.5", "21: tissues[0].damping.mass_per_s", "is the text"},
    {"mass_per_s: 0.5", "mass_per_s: 0.5 1/s", "21: tissues[0].damping.mass_per_s", "is \"0.5 1/s\""},
    {"mass_per_s: 0.5", "mass_per_s: 0,5", "21: tissues[0].damping.mass_per_s", "is \"0,5\""},
    {"mass_per_s: 0.5", "mass_per_s: 0x10", "21: tissues[0].damping.mass_per_s", "is \"0x10\""},
    {"mass_per_s: 0.5", "mass_per_s:", "21: tissues[0].damping.mass_per_s", "is empty; it must be a number"},
    {"mass_per_s: 0.5", "mass_per_s: [0.5]", "21: tissues[0].damping.mass_per_s", "is a list; it must be a number"},
    {"mass_per_s: 0.5", "mass_per_s: .nan", "21: tissues[0].damping.mass_per_s", "is \".nan\""},
    {"mass_per_s: 0.5", "mass_per_s: nan", "21: tissues[0].damping.mass_per_s", "is \"nan\""},
    {"mass_per_s: 0.5", "mass_per_s: .inf", "21: tissues[0].damping.mass_per_s", "is \".inf\""},
    {"mass_per_s: 0.5", "mass_per_s: 1e999", "21: tissues[0].damping.mass_per_s", "is \"1e999\""},
    {"  iterations: 20", "  iterations: 2.5", "65: solver.iterations", "whole number >= 1 and <= 10000"},
    {"remove_unreferenced_nodes: true", "remove_unreferenced_nodes: yes",
     "31: tissues[1].mesh.remove_unreferenced_nodes", "is \"yes\"; it must be true or false"},
    {"remove_unreferenced_nodes: true", "remove_unreferenced_nodes: \"true\"",
     "31: tissues[1].mesh.remove_unreferenced_nodes", "it must be true or false"},
    {"remove_unreferenced_nodes: true", "coincident_nodes: weld", "31: tissues[1].mesh.coincident_nodes",
     "is \"weld\"; allowed here: refuse, merge, keep"},
    {"step: {max_step_s: 0.002, max_gap_s: 0.5}", "step: 0.001", "63: step", "is \"0.001\"; it must be a map"},
    {"    fixed:\n", "    fixed: none\n    damping_:\n", "24: tissues[0].damping_", "did you mean \"damping\"?"},
    {"    contact_links: [jaw]", "    contact_links: jaw", "59: instruments[1].contact_links", "it must be a list"},
    {"    contact_links: [jaw]", "    contact_links: []", "59: instruments[1].contact_links", "at least 1"},
    {"model: linear", "model: neohookean", "16: tissues[0].material.model",
     "did you mean \"neo_hookean\"? allowed here: linear, "},
    {"fine_at: minimum", "fine_at: left", "9: tissues[0].block.grading.x.fine_at",
     "allowed here: minimum, center, maximum"},
    {"    tip_link: tip\n    contact_links:\n", "    tip_link: [tip]\n    contact_links:\n",
     "45: instruments[0].tip_link", "is a list; it must be text"},
    {"      outer_pitch: pitch", "      outer_pitch: yaw", "42: instruments[0].joint_names.outer_pitch",
     "already driven by recorded joint \"outer_yaw\""},
    {"/PSM2/jaw/measured_js", "[/PSM2/jaw]", "39: instruments[0].joint_state_topics[1]", "it must be a map"},
    {"/PSM2/jaw/measured_js", "{triggers: false}", "39: instruments[0].joint_state_topics[1]",
     "required key \"topic\" is missing"},
    {"/PSM2/jaw/measured_js", "{topic: /jaw, triggers: 0}", "39: instruments[0].joint_state_topics[1].triggers",
     "it must be true or false"},
    {"/PSM2/jaw/measured_js", "{topic: /jaw, trigger: false}", "39: instruments[0].joint_state_topics[1].trigger",
     "did you mean \"triggers\"?"},
    {"[/PSM2/measured_js, /PSM2/jaw/measured_js]", "[{topic: /PSM2/measured_js, triggers: false}]",
     "39: instruments[0].joint_state_topics", "no topic triggers, so this instrument would never give a wrench"},
    {"max_gap_s: 0.5", "joint_states: newest", "63: step.joint_states",
     "did you mean \"newest_state\"? allowed here: auto, every_state, newest_state"},
    {"      yaw: 0.25", "      yaw: .inf", "44: instruments[0].initial_joint_positions.yaw", "rad or m"},
    {"      yaw: 0.25", "      yaw: 0.25\n    compliant_joints: [{joint: yaw}]",
     "45: instruments[0].compliant_joints[0]", "stiffness_n_m_per_rad"},
    {"      yaw: 0.25", "      yaw: 0.25\n    compliant_joints: [{joint: yaw, stiffness: 1}]",
     "45: instruments[0].compliant_joints[0].stiffness", "did you mean"},
    {"      yaw: 0.25", "      yaw: 0.25\n    compliant_joints: [{joint: yaw, stiffness_n_m_per_rad: 0}]",
     "45: instruments[0].compliant_joints[0].stiffness_n_m_per_rad", "N m/rad"},
    {"      yaw: 0.25",
     "      yaw: 0.25\n    compliant_joints: [{joint: yaw, stiffness_n_m_per_rad: 1, torque_limit_n_m: 0}]",
     "45: instruments[0].compliant_joints[0].torque_limit_n_m", "force times distance from the joint's axis"},
    {"      yaw: 0.25",
     "      yaw: 0.25\n    compliant_joints: [{joint: yaw, stiffness_n_m_per_rad: 1, force_limit_n: 1}]",
     "45: instruments[0].compliant_joints[0].force_limit_n",
     "a joint that turns has stiffness_n_m_per_rad and torque_limit_n_m"},
};
INSTANTIATE_TEST_SUITE_P(Types, BadSceneTest, testing::ValuesIn(kTypes));

const BadScene kRanges[] = {
    {"[0.1, 0.08, 0.04]", "[100, 80, 40]", "6: tissues[0].block.size_m[0]", "give metres, not millimetres"},
    {"[0.1, 0.08, 0.04]", "[0.1, 0, 0.04]", "6: tissues[0].block.size_m[1]", ">= 1e-06 and <= 10 m"},
    {"[10, 8, 4]", "[0, 8, 4]", "7: tissues[0].block.cells[0]", ">= 1 and <= 200"},
    {"[10, 8, 4]", "[201, 8, 4]", "7: tissues[0].block.cells[0]", ">= 1 and <= 200"},
    {"[10, 8, 4]", "[200, 200, 11]", "7: tissues[0].block.cells", "2200000 tetrahedra"},
    {"growth: 1.25", "growth: 0.5", "9: tissues[0].block.grading.x.growth", ">= 1 and <= 3"},
    {"growth: 1.25", "growth: 3", "9: tissues[0].block.grading.x.growth", "times as long as the smallest"},
    {"youngs_modulus_pa: 5e3", "youngs_modulus_pa: 0.5", "17: tissues[0].material.youngs_modulus_pa", "give pascals"},
    {"youngs_modulus_pa: 5e3", "youngs_modulus_pa: 2e12", "17: tissues[0].material.youngs_modulus_pa", "<= 1e+12 Pa"},
    {"poissons_ratio: 0.45", "poissons_ratio: 0.5", "18: tissues[0].material.poissons_ratio", "> -1 and < 0.5"},
    {"poissons_ratio: 0.45", "poissons_ratio: -1", "18: tissues[0].material.poissons_ratio", "> -1 and < 0.5"},
    {"density_kg_per_m3: 1060", "density_kg_per_m3: 0.9", "19: tissues[0].material.density_kg_per_m3",
     "give kilograms per cubic metre"},
    {"density_kg_per_m3: 1060", "density_kg_per_m3: 2e5", "19: tissues[0].material.density_kg_per_m3", "<= 100000"},
    {"mass_per_s: 0.5", "mass_per_s: -0.5", "21: tissues[0].damping.mass_per_s", ">= 0 and <= 10000 1/s"},
    {"stiffness_s: 0.002", "stiffness_s: 20", "22: tissues[0].damping.stiffness_s", "give seconds"},
    {"rpy_rad: [0.1, 0.2, 0.3]", "rpy_rad: [0, 0, 90]", "14: tissues[0].pose.rpy_rad[2]", "not degrees"},
    {"[0, 0, 1, 0]", "[0, 0, 1, 1]", "32: tissues[1].pose.quaternion_xyzw", "norm 1"},
    {"[0, 0, 1, 0]", "[0, 0, 0, 0]", "32: tissues[1].pose.quaternion_xyzw", "norm 1"},
    {"position_m: [1, 2, 3]", "position_m: [1, 2, 3e4]", "13: tissues[0].pose.position_m[2]", "<= 1000 m"},
    {"min_m: [-1, -2, -3]", "min_m: [2, -2, -3]", "24: tissues[0].fixed[0].box", "min_m greater than its max_m"},
    {"normal: [0, 0, 2]", "normal: [0, 0, 0]", "25: tissues[0].fixed[1].plane.normal", "must point somewhere"},
    {"radius_m: 0.05", "radius_m: 0", "26: tissues[0].fixed[2].sphere.radius_m", ">= 1e-06"},
    {"scale_m_per_unit: 0.01", "scale_m_per_unit: 0", "30: tissues[1].mesh.scale_m_per_unit", "m per file unit"},
    {"length_m: 0.1", "length_m: -0.1", "53: instruments[0].contact_links[1].shapes[2].cylinder.length_m", ">= 1e-06"},
    {"scale: 0.001", "scale: -0.001", "55: instruments[0].contact_links[1].shapes[4].mesh.scale", ">= 1e-09"},
    {"static: 0.6", "static: 0.3", "61: friction[0].static", "smaller than the kinetic one"},
    {"static: 0.6", "static: .nan", "61: friction[0].static", ">= 0 and <= 10"},
    {"kinetic: 0.4", "kinetic: -0.1", "61: friction[0].kinetic", ">= 0 and <= 10"},
    {"max_step_s: 0.002", "max_step_s: 2", "63: step.max_step_s", "give seconds"},
    {"max_step_s: 0.002", "max_step_s: 0.6", "63: step", "max_gap_s is shorter than max_step_s"},
    {"max_step_s: 0.002", "max_step_s: 0.000001", "63: step.max_gap_s", "is more than 100000 times max_step_s"},
    {"max_gap_s: 0.5", "max_lag_s: 0", "63: step.max_lag_s", ">= 1e-06 and <= 60 s"},
    {"max_gap_s: 0.5", "max_lag_s: 200", "63: step.max_lag_s", "give seconds: 20 ms is 0.02"},
    {"max_gap_s: 0.5", "max_lag_s: .nan", "63: step.max_lag_s", "is \".nan\""},
    {"iterations: 20", "iterations: 0", "65: solver.iterations", ">= 1 and <= 10000"},
    {"contact_passes: 3", "contact_passes: 101", "66: solver.contact_passes", ">= 1 and <= 100"},
    {"tolerance: 1.0e-7", "tolerance: 0", "67: solver.tolerance", ">= 1e-16 and <= 0.1"},
};
INSTANTIATE_TEST_SUITE_P(Ranges, BadSceneTest, testing::ValuesIn(kRanges));

const BadScene kNames[] = {
    {"name: pad", "name: 2pad", "4: tissues[0].name", "must begin with a letter"},
    {"name: pad", "name: my-pad", "4: tissues[0].name", "must begin with a letter"},
    {"name: pad", "name: p\303\244d", "4: tissues[0].name", "must begin with a letter"},
    {"name: pad", "name: \"\"", "4: tissues[0].name", "is empty"},
    {"name: pad", "name: a_name_that_is_far_too_long_to_be_read_in_any_list_of_topics_of_a_node", "4: tissues[0].name",
     "at most 64 characters"},
    {"name: organ", "name: pad", "27: tissues[1]", "already used (line 4)"},
    {"name: arm2", "name: pad", "56: instruments[1]", "already used (line 4)"},
    {"world_frame: lab", "world_frame: /lab", "1: world_frame", "must not begin with '/'"},
    {"tf_frame: operating_table", "tf_frame: \"a\\tb\"", "32: tissues[1].pose.tf_frame", "control characters"},
    {"/PSM2/jaw/measured_js", "/PSM2//measured_js", "39: instruments[0].joint_state_topics[1]", "a ROS name must be"},
    {"/PSM2/jaw/measured_js", "/PSM2/measured_js/", "39: instruments[0].joint_state_topics[1]", "a ROS name must be"},
    {"/PSM2/jaw/measured_js", "/PSM2/measured_js", "39: instruments[0].joint_state_topics[1]", "is named twice"},
    {"/PSM2/jaw/measured_js", "~measured_js", "39: instruments[0].joint_state_topics[1]", "write it in full"},
    {"/PSM2/jaw/measured_js", "{topic: /PSM2/measured_js}", "39: instruments[0].joint_state_topics[1]",
     "is named twice"},
    {"/PSM2/jaw/measured_js", "{topic: /PSM2//jaw}", "39: instruments[0].joint_state_topics[1].topic",
     "a ROS name must be"},
    {"      - shaft", "      - jaw", "48: instruments[0].contact_links[1]", "link \"jaw\" is named twice"},
    {"instrument: arm, tissue: pad", "instrument: leg, tissue: pad", "61: friction[0].instrument",
     "unknown instrument \"leg\"; the scene has arm, arm2"},
    {"instrument: arm, tissue: pad", "instrument: arm, tissue: pat", "61: friction[0].tissue",
     "unknown tissue \"pat\"; did you mean \"pad\"? the scene has pad, organ"},
    {"instrument: arm, tissue: organ", "instrument: arm, tissue: pad", "62: friction[1]", "is given twice"},
};
INSTANTIATE_TEST_SUITE_P(Names, BadSceneTest, testing::ValuesIn(kNames));

const BadScene kFiles[] = {
    {"file: organ.vtk", "file: other.vtk", "29: tissues[1].mesh.file", "other.vtk' does not exist"},
    {"file: organ.vtk", "file: organ.step", "29: tissues[1].mesh.file", "allowed endings: .msh, .vtk"},
    {"file: organ.vtk", "file: organ.vtu", "29: tissues[1].mesh.file", "meshio convert FILE organ.vtk"},
    {"urdf: package://tissue_contact/arm.urdf", "urdf: package://tissue_contact/leg.urdf", "36: instruments[0].urdf",
     "leg.urdf' does not exist"},
    {"urdf: package://tissue_contact/arm.urdf", "urdf: arm.urdf.xacro", "36: instruments[0].urdf",
     "is a xacro file; expand it first: xacro arm.urdf.xacro > arm.urdf, or"},
    {"urdf: package://tissue_contact/arm.urdf", "urdf: package://nowhere/arm.urdf", "36: instruments[0].urdf",
     "ROS package \"nowhere\""},
    {"urdf: package://tissue_contact/arm.urdf", "urdf: http://host/arm.urdf", "36: instruments[0].urdf",
     "unknown scheme \"http\""},
    {"scale: [0.001, 0.002, 0.003]", "scale: [0.001, 0.002]",
     "54: instruments[0].contact_links[1].shapes[3].mesh.scale", "has 2 elements"},
    {"file: jaw.STL, scale: 0.001", "file: claw.stl, scale: 0.001",
     "55: instruments[0].contact_links[1].shapes[4].mesh.file", "claw.stl' does not exist"},
};
INSTANTIATE_TEST_SUITE_P(Files, BadSceneTest, testing::ValuesIn(kFiles));

const BadScene kSyntax[] = {
    {"    contact_links: [jaw]", "    contact_links: [jaw", "60: (YAML syntax)", "check indentation"},
    {"  iterations: 20", "  iterations: 20\n contact", "67: (YAML syntax)", "column"},
    {"      poissons_ratio: 0.45", "\t  poissons_ratio: 0.45", "18: (YAML syntax)", "column"},
    {"tf_frame: operating_table", "tf_frame: *nowhere", "32: (YAML syntax)", "column"},
    {"world_frame: lab", "--- {}\n---\nworld_frame: lab", "2: (YAML syntax)", "a second YAML document begins"},
};
INSTANTIATE_TEST_SUITE_P(Syntax, BadSceneTest, testing::ValuesIn(kSyntax));

TEST_F(SceneTest, RefusesAFileWithoutTissue) {
  for (const char* yaml : {"", "\n# nothing\n", "---\n", "~"}) {
    EXPECT_EQ(refusal(yaml).find("scene.yaml:1: scene: is empty"), 0U) << yaml;
  }
  EXPECT_EQ(refusal("{}"), "scene.yaml:1: scene: required key \"tissues\" is missing; add it");
  EXPECT_EQ(refusal("tissues: []").find("scene.yaml:1: tissues: has 0 elements"), 0U);
  EXPECT_EQ(refusal("\ntissues:\n\n").find("scene.yaml:2: tissues: is empty; it must be a list"), 0U);
  EXPECT_EQ(refusal("- tissues").find("scene.yaml:1: scene: is a list; it must be a map"), 0U);
  EXPECT_EQ(refusal("tissues").find("scene.yaml:1: scene: is \"tissues\"; it must be a map"), 0U);
}

// yaml-cpp 0.7 finds one more document in each of these for ever.
TEST_F(SceneTest, RefusesATextInWhichTheParserDoesNotGetOn) {
  for (const std::string& yaml : std::initializer_list<std::string>{std::string("[\0:\0", 4), std::string("\0[\0:", 4),
                                                                    "[:", "[:\x04", "{y{:", "[a:]", "{a: [:]}", ",|<",
                                                                    ",-|-", ",-[<0[", ",]||''&a", "!&,b>,@a"}) {
    EXPECT_EQ(refusal(yaml).find("scene.yaml:1: (YAML syntax): "), 0U) << yaml << ": " << refusal(yaml);
  }
}

std::string repeated(const std::string& text, std::size_t times) {
  std::string all;
  for (std::size_t i = 0; i < times; ++i) all += text;
  return all;
}

TEST_F(SceneTest, BoundsWhatAFileCanCost) {
  std::string laughs = "a0: &a0 [lol, lol, lol, lol, lol, lol, lol, lol, lol, lol]\n";
  for (int level = 1; level < 30; ++level) {
    const std::string below = "*a" + std::to_string(level - 1);
    laughs +=
        "a" + std::to_string(level) + ": &a" + std::to_string(level) + " [" + below + repeated(", " + below, 9) + "]\n";
  }
  const std::pair<std::string, std::string> costly[] = {
      {laughs, "more than 100000 values"},
      {"tissues: &t [*t]", "alias of itself"},
      {"tissues: " + repeated("[", 40) + repeated("]", 40), "more than 32 levels"},
      {repeated("[", 200000), "nested too deeply"},
      {repeated("{", 200000), "nested too deeply"},
      {repeated("- ", 200000), "nested too deeply"},
      {"tissues: [" + repeated("1,", 200000) + "]", "more than 100000 values"},
      {std::string(3U << 20U, '#'), "at most 1048576 are allowed"},
      {std::string(500, 'k') + ": 1", "unknown key"},
  };
  for (const auto& [yaml, problem] : costly) {
    const auto begin = std::chrono::steady_clock::now();
    const std::string message = refusal(yaml);
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - begin;
    EXPECT_NE(message.find(problem), std::string::npos) << message;
    EXPECT_LT(message.size(), 1000U);
    EXPECT_LT(seconds.count(), 20.0) << problem;  // a hang, not a slow machine
  }
}

TEST_F(SceneTest, SurvivesDamagedText) { EXPECT_GT(refusedWhenDamaged(kFullScene), 1000); }

}  // namespace bad_scene_test
}  // namespace tissue_contact
