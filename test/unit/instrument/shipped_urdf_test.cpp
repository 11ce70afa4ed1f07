/// @file
/// The URDFs of this repository and, where it is there, a whole robot made by others.

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <filesystem>
#include <memory>
#include <random>
#include <string>
#include <variant>
#include <vector>

#include "instrument_fixture.h"
#include "tissue_contact/instrument/collision_shape.h"
#include "tissue_contact/instrument/instrument.h"
#include "tissue_contact/instrument/instrument_description.h"
#include "tissue_contact/mesh/triangle_mesh.h"
#include "unit/mesh/mesh_fixture.h"

namespace tissue_contact {
namespace shipped_urdf_test {

const Vector3 kX = Vector3::UnitX();
const Vector3 kY = Vector3::UnitY();
const Vector3 kZ = Vector3::UnitZ();

/// Positions of a model's joints by name, and the pose of a link there.
class Posed {
 public:
  explicit Posed(const RobotModel& model) : model_(model) {
    positions_ = VectorX::Zero(static_cast<Eigen::Index>(model.joints().size()));
  }
  void set(const std::string& joint, double position) {
    const int index = model_.findJoint(joint);
    ASSERT_GE(index, 0) << joint;
    positions_[index] = position;
  }
  Pose of(const std::string& link) const {
    std::vector<Pose> X_BL;
    model_.forwardKinematics(positions_, X_BL);
    return X_BL.at(static_cast<std::size_t>(model_.findLink(link)));
  }

 private:
  const RobotModel& model_;
  VectorX positions_;
};

// ------------------------------------------------------------------------------------------- urdf/psm_classic.urdf

/// One row of the modified-DH (Craig) table, as matrices.
Pose dhRow(double alpha, double a, double theta, double d) {
  return rotation(alpha, kX) * translation(a, 0, 0) * rotation(theta, kZ) * translation(0, 0, d);
}

/// Tip pose by the table of the arm, independently of the URDF.
Pose psmTip(const std::array<double, 6>& q) {
  const double h = M_PI / 2;
  Pose tip = Pose::Identity();
  tip.linear() << 0, -1, 0, 0, 0, 1, -1, 0, 0;
  return dhRow(h, 0, q[0] + h, 0) * dhRow(-h, 0, q[1] - h, 0) * dhRow(h, 0, 0, q[2] - 0.4318) *
         dhRow(0, 0, q[3], 0.4162) * dhRow(-h, 0, q[4] - h, 0) * dhRow(-h, 0.0091, q[5] - h, 0) * tip;
}

const std::array<std::string, 6> kPsmJoints = {"yaw", "pitch", "insertion", "roll", "wrist_pitch", "wrist_yaw"};

RobotModel psm() { return loadUrdf(TISSUE_CONTACT_SOURCE_DIR "/urdf/psm_classic.urdf", nullptr); }

TEST(PsmClassic, ArmFollowsItsDhTable) {
  const RobotModel model = psm();
  std::mt19937 random(7);
  for (int trial = 0; trial < 200; ++trial) {
    Posed posed(model);
    std::array<double, 6> q{};
    for (std::size_t i = 0; i < 6; ++i) {
      const IndependentJoint& joint = model.joints().at(static_cast<std::size_t>(model.findJoint(kPsmJoints[i])));
      q[i] = std::uniform_real_distribution<double>(joint.lower, joint.upper)(random);
      posed.set(kPsmJoints[i], q[i]);
    }
    expectSamePose(posed.of("tip"), psmTip(q), 1e-12);
  }
}

TEST(PsmClassic, IndependentJointsAreTheArmAndTheJawInOrder) {
  const RobotModel model = psm();
  ASSERT_EQ(model.joints().size(), 7u);
  for (std::size_t i = 0; i < 6; ++i) EXPECT_EQ(model.joints()[i].name, kPsmJoints[i]);
  EXPECT_EQ(model.joints()[6].name, "jaw");
}

TEST(PsmClassic, JawsOpenSymmetricallyByHalfTheAngleEach) {
  const RobotModel model = psm();
  Posed posed(model);
  posed.set("insertion", 0.1);
  posed.set("wrist_yaw", 0.3);
  posed.set("jaw", 0.8);
  const Pose X = posed.of("jaw_base");
  expectSamePose(posed.of("jaw_1_link"), X * rotation(0.4, kZ), 1e-14);
  expectSamePose(posed.of("jaw_2_link"), X * rotation(-0.4, kZ), 1e-14);
  // Opening parts the ends, to either side of the tip's z axis.
  const Pose X_TipWorld = posed.of("tip").inverse();
  const Vector3 end_1 = X_TipWorld * (posed.of("jaw_1_link") * Vector3(0, 0.01, 0));
  const Vector3 end_2 = X_TipWorld * (posed.of("jaw_2_link") * Vector3(0, 0.01, 0));
  EXPECT_NEAR(end_1.z(), 0.01 * std::cos(0.4), 1e-12);
  EXPECT_NEAR((end_1 - end_2).norm(), 2 * 0.01 * std::sin(0.4), 1e-12);
}

TEST(PsmClassic, ShapesLieWhereTheInstrumentIs) {
  InstrumentDescription description;
  description.name = "psm";
  description.joint_state_topics = {{"js"}};
  description.tip_link = "tip";
  description.contact_links = {{"shaft", {}}, {"wrist", {}}, {"jaw_base", {}}, {"jaw_1_link", {}}, {"jaw_2_link", {}}};
  const Instrument instrument(description, psm(), Pose::Identity());
  const auto& links = instrument.contactLinks();
  std::vector<Pose> X_WL;
  instrument.linkPoses(instrument.initialPositions(), X_WL);
  const Pose X_TipW = X_WL[static_cast<std::size_t>(instrument.tipLink())].inverse();
  const auto point = [&](std::size_t link, const Vector3& p_S) {
    return Vector3(X_TipW * (X_WL[static_cast<std::size_t>(links[link].link)] * (links[link].shapes.at(0).X_LS * p_S)));
  };
  // At zero the instrument is straight: seen from the tip frame (z along the jaws) all of it lies on the z axis.
  const auto& shaft = std::get<CylinderGeometry>(links[0].shapes.at(0).geometry);
  EXPECT_EQ(shaft.radius_m, 0.0042);
  EXPECT_LE((point(0, Vector3(0, 0, shaft.length_m / 2)) - Vector3(0, 0, -0.0091)).norm(), 1e-12);
  EXPECT_LE((point(0, Vector3(0, 0, -shaft.length_m / 2)) - Vector3(0, 0, -0.0091 - shaft.length_m)).norm(), 1e-12);
  const auto& wrist = std::get<CylinderGeometry>(links[1].shapes.at(0).geometry);
  EXPECT_LE((point(1, Vector3(0, 0, wrist.length_m / 2)) - Vector3::Zero()).norm(), 1e-12);
  for (const std::size_t jaw : {3u, 4u}) {
    const auto& body = std::get<CylinderGeometry>(links[jaw].shapes.at(0).geometry);
    const auto& end = std::get<SphereGeometry>(links[jaw].shapes.at(1).geometry);
    const Vector3 center = point(jaw, Vector3::Zero());
    EXPECT_NEAR(center.z(), body.length_m / 2, 1e-12);           // begins at the pivot
    EXPECT_NEAR(center.head<2>().norm(), body.radius_m, 1e-12);  // closed jaws touch in the middle
    EXPECT_EQ(end.radius_m, body.radius_m);
    EXPECT_NEAR(body.length_m + end.radius_m, 0.010, 1e-12);  // 10 mm long
  }
}

// ------------------------------------------------------------------------------------------------- urdf/probe.urdf

TEST(Probe, StageMovesTheTipAlongTheAxes) {
  const RobotModel model = loadUrdf(TISSUE_CONTACT_SOURCE_DIR "/urdf/probe.urdf", nullptr);
  ASSERT_EQ(model.joints().size(), 3u);
  Posed posed(model);
  posed.set("x", 0.01);
  posed.set("y", -0.02);
  posed.set("z", 0.03);
  expectSamePose(posed.of("tip"), translation(0.01, -0.02, 0.03), 0.0);
}

TEST(Probe, TipIsASphereWithAStemThatStartsInsideIt) {
  const RobotModel model = loadUrdf(TISSUE_CONTACT_SOURCE_DIR "/urdf/probe.urdf", nullptr);
  const LinkGeometry& tip = model.links()[static_cast<std::size_t>(model.findLink("tip"))].geometry;
  ASSERT_EQ(tip.collision.size(), 2u);
  EXPECT_EQ(tip.visual.size(), 2u);
  const double radius = std::get<SphereGeometry>(tip.collision[0].geometry).radius_m;
  EXPECT_EQ(radius, 0.005);
  expectSamePose(tip.collision[0].X_LS, Pose::Identity(), 0.0);
  const auto& stem = std::get<CylinderGeometry>(tip.collision[1].geometry);
  const double bottom = tip.collision[1].X_LS.translation().z() - stem.length_m / 2;
  EXPECT_GT(bottom, 0.0);
  EXPECT_LT(std::hypot(bottom, stem.radius_m), radius);
}

// ------------------------------------------------------------------------- a PSM made by others, meshes and all

class SurrolPsm : public testing::Test {
 protected:
  void SetUp() override {
    if (!std::filesystem::exists(kFile)) GTEST_SKIP() << "no robot at " << kFile;
    model_ = std::make_unique<RobotModel>(loadUrdf(kFile, nullptr));
  }
  static constexpr char kFile[] = TISSUE_CONTACT_SHARED_DATA "/surrol_psm/psm.urdf";
  std::unique_ptr<RobotModel> model_;
};

TEST_F(SurrolPsm, MimicJointsMoveWithTheirDrive) {
  // Independent: yaw, insertion, roll, wrist pitch and yaw, one gripper, and the parallelogram's back joint.
  ASSERT_EQ(model_->joints().size(), 7u);
  EXPECT_EQ(model_->findJoint("psm_pitch_end_joint"), -1);
  EXPECT_EQ(model_->findJoint("psm_tool_gripper1_joint"), -1);

  const double yaw = 0.4;
  const double pitch = -0.3;
  const double insertion = 0.12;
  const double grip = 0.25;
  Posed posed(*model_);
  posed.set("psm_yaw_joint", yaw);
  posed.set("psm_pitch_back_joint", pitch);
  posed.set("psm_main_insertion_joint", insertion);
  posed.set("psm_tool_gripper2_joint", grip);

  // Right angles as that file writes them, composed by hand: rpy = Rz Ry Rx.
  const double h = 1.57079632679;
  const Pose X_yaw = translation(0, 0.4864, 0) * rotation(-h, kY) * rotation(h, kX) * rotation(yaw, kZ);
  expectSamePose(posed.of("psm_yaw_link"), X_yaw, 1e-14);
  const Pose X_pitch = X_yaw * rotation(-h, kY) * rotation(-h, kX) * rotation(pitch, kZ);  // mimics, multiplier 1
  expectSamePose(posed.of("psm_pitch_end_link"), X_pitch, 1e-14);
  const Pose X_insertion = X_pitch * translation(0, 0.4318, 0) * rotation(h, kX) * translation(0, 0, insertion);
  expectSamePose(posed.of("psm_main_insertion_link"), X_insertion, 1e-14);
  const Pose X_back =
      X_yaw * translation(0, 0, 0.516) * rotation(-0.29038632563, kY) * rotation(-h, kX) * rotation(pitch, kZ);
  const Pose X_bottom = X_back * translation(0.15, 0, 0) * rotation(1.86118265242, kZ) * rotation(-pitch, kZ);
  expectSamePose(posed.of("psm_pitch_bottom_link"), X_bottom, 1e-14);  // mimics, multiplier -1
  const Pose X_wrist = X_insertion * translation(0, 0, 0.4162) * rotation(-h, kY) * rotation(-h, kX) *
                       translation(0.0091, 0, 0) * rotation(-h, kY) * rotation(-h, kX);
  expectSamePose(posed.of("psm_tool_yaw_link"), X_wrist, 1e-14);
  expectSamePose(posed.of("psm_tool_gripper2_link"), X_wrist * rotation(grip, kZ), 1e-14);
  expectSamePose(posed.of("psm_tool_gripper1_link"), X_wrist * rotation(-grip, kZ), 1e-14);  // multiplier -1
}

TEST_F(SurrolPsm, EveryShapeOfTheUrdfLoads) {
  int collision_meshes = 0;
  int visual_meshes = 0;
  for (const RobotModel::Link& link : model_->links()) {
    SCOPED_TRACE(link.name);
    for (const ShapeDescription& description : link.geometry.collision) {
      const CollisionShape shape = makeCollisionShape(description);
      collision_meshes += shape.mesh ? 1 : 0;
    }
    for (const ShapeDescription& description : link.geometry.visual) {
      const CollisionShape shape = makeCollisionShape(description);
      visual_meshes += shape.mesh ? 1 : 0;
    }
  }
  EXPECT_EQ(collision_meshes, 2);
  EXPECT_EQ(visual_meshes, 15);
}

TEST_F(SurrolPsm, ToolMeshesHaveTheSizeOfTheTool) {
  InstrumentDescription description;
  description.name = "psm";
  description.joint_state_topics = {{"js"}};
  description.tip_link = "psm_tool_tip_link";
  description.contact_links = {{"psm_tool_pitch_link", {}}, {"psm_tool_gripper1_link", {}}};
  const Instrument instrument(description, *model_, Pose::Identity());
  const CollisionShape& wrist = instrument.contactLinks()[0].shapes.at(0);
  ASSERT_NE(wrist.mesh, nullptr);
  const Vector3 size = wrist.mesh->vertices.rowwise().maxCoeff() - wrist.mesh->vertices.rowwise().minCoeff();
  EXPECT_GT(size.x(), 0.0091);  // longer than the distance of its two axes, in metres
  EXPECT_LT(size.maxCoeff(), 0.02);
  EXPECT_TRUE(std::holds_alternative<BoxGeometry>(instrument.contactLinks()[1].shapes.at(0).geometry));
}

TEST_F(SurrolPsm, EveryCollisionMeshInTheFolderLoads) {
  int count = 0;
  for (const auto& entry :
       std::filesystem::directory_iterator(TISSUE_CONTACT_SHARED_DATA "/surrol_psm/meshes/collision")) {
    SCOPED_TRACE(entry.path().string());
    const TriangleMesh mesh = loadTriangleMesh(entry.path().string(), Vector3::Ones());
    EXPECT_FALSE(mesh.triangles.empty());
    EXPECT_LT(mesh.vertices.cwiseAbs().maxCoeff(), 1.0);  // metres
    EXPECT_GE(enclosedVolume(mesh), 0.0);
    ++count;
  }
  EXPECT_EQ(count, 17);
}

TEST(OrganSurface, LargeClosedMeshIsConnectedAndOutward) {
  const char file[] = TISSUE_CONTACT_SHARED_DATA "/organs/Liver.stl";
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "no mesh at " << file;
  const TriangleMesh mesh = loadTriangleMesh(file, Vector3::Ones());
  EXPECT_EQ(mesh.triangles.size(), 30726u);
  EXPECT_TRUE(isClosedAndOriented(mesh));
  // Euler's formula for a closed surface without handles: V = 2 + F/2.
  EXPECT_EQ(mesh.vertices.cols(), 2 + 30726 / 2);
  EXPECT_GT(enclosedVolume(mesh), 0.0);
}

}  // namespace shipped_urdf_test
}  // namespace tissue_contact
