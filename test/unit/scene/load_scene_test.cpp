/// What a good scene file becomes: every field when every key is set, every default when none is.
#include "scene_fixture.h"

namespace tissue_contact {
namespace load_scene_test {

TEST_F(SceneTest, FillsTheTopLevel) {
  const Scene scene = parse(kFullScene);
  EXPECT_EQ(scene.file, path("scene.yaml"));
  EXPECT_EQ(scene.world_frame, "lab");
  EXPECT_EQ(scene.gravity_m_per_s2, Vector3(0.1, 0.2, -9.81));
  EXPECT_EQ(scene.tissues.size(), 2U);
  EXPECT_EQ(scene.instruments.size(), 2U);
  EXPECT_EQ(scene.step.max_step_s, 0.002);
  EXPECT_EQ(scene.step.max_gap_s, 0.5);
  EXPECT_EQ(scene.solver.iterations, 20);
  EXPECT_EQ(scene.solver.contact_passes, 3);
  EXPECT_EQ(scene.solver.tolerance, 1e-7);
}

TEST_F(SceneTest, FillsABlockTissue) {
  const TissueDescription tissue = parse(kFullScene).tissues.at(0);
  EXPECT_EQ(tissue.name, "pad");
  const auto& block = std::get<BlockDescription>(tissue.geometry);
  EXPECT_EQ(block.size_m, Vector3(0.1, 0.08, 0.04));
  EXPECT_EQ(block.cells, (std::array<int, 3>{10, 8, 4}));
  EXPECT_EQ(block.grading[0].growth, 1.25);
  EXPECT_EQ(block.grading[0].fine_at, AxisGrading::FineAt::kMinimum);
  EXPECT_EQ(block.grading[1].growth, 1.5);
  EXPECT_EQ(block.grading[1].fine_at, AxisGrading::FineAt::kCenter);
  EXPECT_EQ(block.grading[2].growth, 2.0);
  EXPECT_EQ(block.grading[2].fine_at, AxisGrading::FineAt::kMaximum);
  EXPECT_EQ(tissue.material.model, ElasticModel::kLinear);
  EXPECT_EQ(tissue.material.youngs_modulus_pa, 5000.0);
  EXPECT_EQ(tissue.material.poissons_ratio, 0.45);
  EXPECT_EQ(tissue.material.density_kg_per_m3, 1060.0);
  EXPECT_EQ(tissue.damping.mass_per_s, 0.5);
  EXPECT_EQ(tissue.damping.stiffness_s, 0.002);
}

TEST_F(SceneTest, FillsPoses) {
  const Scene scene = parse(kFullScene);
  const PoseDescription& pad = scene.tissues.at(0).pose;
  EXPECT_EQ(pad.X.translation(), Vector3(1, 2, 3));
  EXPECT_TRUE(pad.tf_frame.empty());
  // Fixed axes, roll first: written out, so that a swapped order shows.
  const double cr = std::cos(0.1), sr = std::sin(0.1), cp = std::cos(0.2), sp = std::sin(0.2), cy = std::cos(0.3),
               sy = std::sin(0.3);
  Matrix3 R;
  R << cy * cp, cy * sp * sr - sy * cr, cy * sp * cr + sy * sr, sy * cp, sy * sp * sr + cy * cr, sy * sp * cr - cy * sr,
      -sp, cp * sr, cp * cr;
  EXPECT_LT((pad.X.linear() - R).norm(), 1e-15);

  const PoseDescription& organ = scene.tissues.at(1).pose;
  EXPECT_EQ(organ.tf_frame, "operating_table");
  EXPECT_EQ(organ.X.translation(), Vector3::Zero());
  EXPECT_LT((organ.X.linear() - Vector3(-1, -1, 1).asDiagonal().toDenseMatrix()).norm(), 1e-15);
  EXPECT_EQ(scene.instruments.at(0).base_pose.X.translation(), Vector3(0.2, 0, 0));
}

TEST_F(SceneTest, FillsFixedRegions) {
  const std::vector<Region> fixed = parse(kFullScene).tissues.at(0).fixed;
  ASSERT_EQ(fixed.size(), 3U);
  EXPECT_EQ(std::get<BoxRegion>(fixed[0]).min_m, Vector3(-1, -2, -3));
  EXPECT_EQ(std::get<BoxRegion>(fixed[0]).max_m, Vector3(1, 2, 3));
  EXPECT_EQ(std::get<PlaneRegion>(fixed[1]).point_m, Vector3(0, 0, 0.01));
  EXPECT_EQ(std::get<PlaneRegion>(fixed[1]).normal, Vector3(0, 0, 1)) << "stored with unit length";
  EXPECT_EQ(std::get<SphereRegion>(fixed[2]).center_m, Vector3(0.1, 0.2, 0.3));
  EXPECT_EQ(std::get<SphereRegion>(fixed[2]).radius_m, 0.05);
}

TEST_F(SceneTest, FillsAMeshTissue) {
  const auto mesh = std::get<MeshDescription>(parse(kFullScene).tissues.at(1).geometry);
  EXPECT_EQ(mesh.file, path("organ.vtk"));
  EXPECT_EQ(mesh.scale_m_per_unit, 0.01);
  EXPECT_TRUE(mesh.remove_unreferenced_nodes);
  EXPECT_EQ(mesh.coincident_nodes, CoincidentNodes::kRefuse);
  const std::string merging = replaced(kFullScene, "remove_unreferenced_nodes: true", "coincident_nodes: merge");
  EXPECT_EQ(std::get<MeshDescription>(parse(merging).tissues.at(1).geometry).coincident_nodes, CoincidentNodes::kMerge);
}

TEST_F(SceneTest, FillsAnInstrument) {
  const InstrumentDescription arm = parse(kFullScene).instruments.at(0);
  EXPECT_EQ(arm.name, "arm");
  EXPECT_EQ(arm.urdf_file, path("arm.urdf"));
  EXPECT_TRUE(arm.robot_description_parameter.empty());
  ASSERT_EQ(arm.joint_state_topics.size(), 2U);
  EXPECT_EQ(arm.joint_state_topics[0].name, "/PSM2/measured_js");
  EXPECT_TRUE(arm.joint_state_topics[0].triggers);
  EXPECT_EQ(arm.joint_state_topics[1].name, "/PSM2/jaw/measured_js");
  EXPECT_FALSE(arm.joint_state_topics[1].triggers);
  EXPECT_EQ(arm.joint_names, (std::map<std::string, std::string>{{"outer_yaw", "yaw"}, {"outer_pitch", "pitch"}}));
  EXPECT_EQ(arm.initial_joint_positions, (std::map<std::string, double>{{"yaw", 0.25}}));
  EXPECT_EQ(arm.tip_link, "tip");
  EXPECT_EQ(parse(kFullScene).instruments.at(1).robot_description_parameter, "/arm2/robot_description");
}

TEST_F(SceneTest, ReadsCompliantJoints) {
  const InstrumentDescription arm =
      parse(replaced(kFullScene, "      yaw: 0.25",
                     "      yaw: 0.25\n    compliant_joints: [{joint: jaw, stiffness_n_m_per_rad: 0.5, "
                     "torque_limit_n_m: 0.02}, {joint: finger, stiffness_n_per_m: 800}]"))
          .instruments.at(0);
  ASSERT_EQ(arm.compliant_joints.size(), 2U);
  EXPECT_EQ(arm.compliant_joints[0].joint, "jaw");
  EXPECT_FALSE(arm.compliant_joints[0].slides);
  EXPECT_EQ(arm.compliant_joints[0].stiffness, 0.5);
  EXPECT_EQ(arm.compliant_joints[0].effort_limit, 0.02);
  EXPECT_TRUE(arm.compliant_joints[1].slides);
  EXPECT_EQ(arm.compliant_joints[1].stiffness, 800.0);
  EXPECT_EQ(arm.compliant_joints[1].effort_limit, std::numeric_limits<double>::infinity());
}

TEST_F(SceneTest, KnowsWhichTopicsTrigger) {
  struct Case {
    const char* topics;
    std::vector<bool> triggers;
  };
  const std::vector<Case> cases = {
      {"[/PSM1/measured_js, /PSM1/jaw/measured_js]", {true, false}},  // CRTK
      {"[/PSM1/jaw/setpoint_js, /PSM1/setpoint_js]", {false, true}},
      {"[/PSM1/measured_js, /PSM1/gripper/measured_js]", {true, false}},
      {"[/dvrk/PSM2/state_joint_current, /dvrk/PSM2/state_jaw_current]", {true, false}},  // dVRK before CRTK
      {"[/arm, /Gripper]", {true, false}},
      {"[/jaw/measured_js]", {true}},                   // alone
      {"[/left_jaw/js, /right_jaw/js]", {true, true}},  // nothing else would trigger
      {"[/jawbone/js, /arm/js]", {true, true}},         // no word of its own
      {"[/arm/measured_js, /wrist/measured_js]", {true, true}},
      {"[/arm, {topic: /jaw, triggers: true}]", {true, true}},
      {"[{topic: /arm, triggers: false}, /wrist]", {false, true}},
      {"[{topic: /arm, triggers: false}, /jaw]", {false, true}},
      {"[{topic: /arm}, {topic: /jaw}]", {true, false}},
  };
  for (const Case& c : cases) {
    SCOPED_TRACE(c.topics);
    const std::string given = "[/PSM2/measured_js, /PSM2/jaw/measured_js]";
    std::string yaml = kFullScene;
    const InstrumentDescription arm = parse(yaml.replace(yaml.find(given), given.size(), c.topics)).instruments.at(0);
    ASSERT_EQ(arm.joint_state_topics.size(), c.triggers.size());
    for (std::size_t i = 0; i < c.triggers.size(); ++i) {
      EXPECT_EQ(arm.joint_state_topics[i].triggers, c.triggers[i]) << arm.joint_state_topics[i].name;
    }
  }
}

TEST_F(SceneTest, FillsThePolicyForJointStates) {
  const std::pair<const char*, StatePolicy> words[] = {{"auto", StatePolicy::kAuto},
                                                       {"every_state", StatePolicy::kEveryState},
                                                       {"newest_state", StatePolicy::kNewestState}};
  for (const auto& [word, policy] : words) {
    const std::string step = "step: {joint_states: " + std::string(word) + ", max_lag_s: 0.005}\n";
    const StepDescription filled = parse(kSmallestScene + step).step;
    EXPECT_EQ(filled.joint_states, policy);
    EXPECT_EQ(filled.max_lag_s, 0.005);
  }
}

TEST_F(SceneTest, FillsContactShapes) {
  const std::vector<ContactLinkDescription> links = parse(kFullScene).instruments.at(0).contact_links;
  ASSERT_EQ(links.size(), 2U);
  EXPECT_EQ(links[0].link, "shaft");
  EXPECT_TRUE(links[0].shapes.empty());
  EXPECT_EQ(links[1].link, "jaw");
  const std::vector<ShapeDescription>& shapes = links[1].shapes;
  ASSERT_EQ(shapes.size(), 5U);
  EXPECT_EQ(std::get<SphereGeometry>(shapes[0].geometry).radius_m, 0.002);
  EXPECT_TRUE(shapes[0].X_LS.isApprox(Pose::Identity()));
  EXPECT_EQ(std::get<BoxGeometry>(shapes[1].geometry).size_m, Vector3(0.01, 0.02, 0.03));
  EXPECT_EQ(shapes[1].X_LS.translation(), Vector3(0, 0, 0.005));
  EXPECT_LT((shapes[1].X_LS.linear() * Vector3::UnitX() - Vector3(std::cos(1.5), std::sin(1.5), 0)).norm(), 1e-15);
  EXPECT_EQ(std::get<CylinderGeometry>(shapes[2].geometry).radius_m, 0.004);
  EXPECT_EQ(std::get<CylinderGeometry>(shapes[2].geometry).length_m, 0.1);
  EXPECT_EQ(std::get<MeshGeometry>(shapes[3].geometry).file, path("jaw.STL"));
  EXPECT_EQ(std::get<MeshGeometry>(shapes[3].geometry).scale, Vector3(0.001, 0.002, 0.003));
  EXPECT_EQ(std::get<MeshGeometry>(shapes[4].geometry).scale, Vector3(0.001, 0.001, 0.001));
}

TEST_F(SceneTest, FillsFrictionPairs) {
  const std::vector<FrictionDescription> friction = parse(kFullScene).friction;
  ASSERT_EQ(friction.size(), 2U);
  EXPECT_EQ(friction[0].instrument, "arm");
  EXPECT_EQ(friction[0].tissue, "pad");
  EXPECT_EQ(friction[0].law.kind, FrictionLawDescription::Kind::kIsotropic);
  EXPECT_EQ(friction[0].law.static_coefficients, std::vector<double>{0.6});
  EXPECT_EQ(friction[0].law.kinetic_coefficients, std::vector<double>{0.4});
  EXPECT_EQ(friction[0].law.axis, FrictionLawDescription::Axis::kNone);
  EXPECT_EQ(friction[1].tissue, "organ");
}

TEST_F(SceneTest, HasDefaults) {
  const Scene scene = parse(kSmallestScene);
  const Scene defaults;
  EXPECT_EQ(scene.world_frame, "world");
  EXPECT_EQ(scene.gravity_m_per_s2, Vector3::Zero());
  EXPECT_EQ(scene.step.max_step_s, defaults.step.max_step_s);
  EXPECT_EQ(scene.step.max_gap_s, defaults.step.max_gap_s);
  EXPECT_EQ(scene.step.joint_states, StatePolicy::kAuto);
  EXPECT_EQ(scene.step.max_lag_s, 0.02);
  EXPECT_EQ(scene.solver.iterations, defaults.solver.iterations);
  EXPECT_EQ(scene.solver.contact_passes, 20);
  EXPECT_EQ(scene.solver.tolerance, 1e-3);
  EXPECT_TRUE(scene.friction.empty());
  const TissueDescription& tissue = scene.tissues.at(0);
  EXPECT_TRUE(tissue.pose.X.isApprox(Pose::Identity()));
  EXPECT_EQ(tissue.material.model, ElasticModel::kCorotational);
  EXPECT_EQ(tissue.damping.mass_per_s, 0.0);
  EXPECT_EQ(tissue.damping.stiffness_s, 0.0);
  EXPECT_TRUE(tissue.fixed.empty());
  EXPECT_EQ(std::get<BlockDescription>(tissue.geometry).grading[1].growth, 1.0);
  const InstrumentDescription& arm = scene.instruments.at(0);
  EXPECT_EQ(arm.robot_description_parameter, "robot_description");
  EXPECT_TRUE(arm.urdf_file.empty());
  EXPECT_TRUE(arm.joint_state_topics.empty());
}

TEST_F(SceneTest, ExpandsAnchors) {
  const Scene scene = parse(R"(tissues:
  - name: a
    block: &block {size_m: [0.1, 0.1, 0.04], cells: [2, 2, 1]}
    material: &soft {youngs_modulus_pa: 5000, poissons_ratio: 0.45, density_kg_per_m3: 1000}
  - {name: b, block: *block, material: *soft}
)");
  EXPECT_EQ(scene.tissues.at(1).material.youngs_modulus_pa, 5000.0);
  EXPECT_TRUE(scene.instruments.empty());
}

TEST_F(SceneTest, LoadsFromAFile) {
  write("scene.yaml", kSmallestScene);
  const Scene scene = loadScene(path("scene.yaml"), nullptr);
  EXPECT_EQ(scene.tissues.at(0).name, "pad");
  EXPECT_EQ(scene.file, path("scene.yaml"));
}

TEST_F(SceneTest, LoadsFromAPackage) {
  write("scene.yaml", kSmallestScene);
  const auto package_path = [this](const std::string& package) {
    return package == "known" ? directory_.path().string() : std::string();
  };
  EXPECT_EQ(loadScene("package://known/scene.yaml", package_path).file, path("scene.yaml"));
  EXPECT_EQ(loadScene("file://" + path("scene.yaml"), package_path).file, path("scene.yaml"));
  EXPECT_THROW(loadScene("package://unknown/scene.yaml", package_path), std::invalid_argument);
}

TEST_F(SceneTest, RefusesWhatIsNotAReadableFile) {
  for (const std::string& file : {path("absent.yaml"), directory_.path().string(), std::string("/dev/zero")}) {
    const std::string message = tissue_contact::refusal([&] { loadScene(file, nullptr); });
    EXPECT_EQ(message.find("scene file '" + file + "' "), 0U) << message;
  }
}

TEST(ShippedScene, EachLoads) {
  const std::string root = TISSUE_CONTACT_SOURCE_DIR;
  int scenes = 0;
  for (const auto& entry : std::filesystem::directory_iterator(root + "/config")) {
    if (entry.path().extension() != ".yaml") continue;
    ++scenes;
    EXPECT_NO_THROW(loadScene(entry.path().string(), [&root](const std::string& package) {
      return package == "tissue_contact" ? root : std::string();
    })) << entry.path();
  }
  EXPECT_GE(scenes, 3);
}

}  // namespace load_scene_test
}  // namespace tissue_contact
