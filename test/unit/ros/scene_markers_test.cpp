/// @file
/// Markers of a scene: what RViz gets, without RViz; and the conversions they use.
#include "tissue_contact/ros/scene_markers.h"

#include <gtest/gtest.h>

#include <limits>
#include <map>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>

#include "tissue_contact/ros/conversions.h"
#include "tissue_contact/scene/load_scene.h"

namespace tissue_contact {
namespace {

using visualization_msgs::Marker;

constexpr std::int64_t kSecond = 1000000000;

const char* const kScene = R"(
world_frame: room
tissues:
  - name: block
    block: {size_m: [0.06, 0.06, 0.02], cells: [4, 4, 2]}
    material: {youngs_modulus_pa: 5000, poissons_ratio: 0.4, density_kg_per_m3: 1000}
    damping: {stiffness_s: 0.003}
    fixed: [{plane: {point_m: [0, 0, 0], normal: [0, 0, 1]}}]
instruments:
  - name: probe
    urdf: package://tissue_contact/urdf/probe.urdf
    base_pose: {position_m: [0, 0, 0.026]}
    joint_state_topics: [/probe]
    tip_link: tip
    contact_links: [tip]
friction: [{instrument: probe, tissue: block, static: 0.5, kinetic: 0.4}]
)";

Simulator makeSimulator() {
  const PackagePath package_path = [](const std::string&) { return std::string(TISSUE_CONTACT_SOURCE_DIR); };
  SceneEnvironment environment;
  environment.package_path = package_path;
  return {parseScene(kScene, "test.yaml", package_path), environment};
}

std::map<std::string, int> countByNamespace(const visualization_msgs::MarkerArray& array, int action) {
  std::map<std::string, int> count;
  for (const Marker& marker : array.markers) count[marker.ns] += static_cast<int>(marker.action == action);
  return count;
}

TEST(SceneMarkers, ShowTissueToolAndForcesInTheWorldFrame) {
  Simulator simulator = makeSimulator();
  SceneMarkers markers(simulator, MarkerStyle());
  const auto rest = countByNamespace(markers.update(kSecond), Marker::ADD);
  EXPECT_EQ(rest.at("block"), 2);  // triangles and edges
  EXPECT_EQ(rest.at("probe"), 2);  // ball and stem
  EXPECT_EQ(rest.count("contact_forces"), 0U);

  simulator.advance(0.1, {Vector3(0, 0, -0.005)});
  const visualization_msgs::MarkerArray& pressed = markers.update(2 * kSecond);
  EXPECT_GT(countByNamespace(pressed, Marker::ADD).at("contact_forces"), 0);
  std::set<std::pair<std::string, int>> ids;
  for (const Marker& marker : pressed.markers) {
    EXPECT_EQ(marker.header.frame_id, "room");
    EXPECT_EQ(marker.header.stamp, ros::Time(2, 0));
    EXPECT_TRUE(ids.emplace(marker.ns, marker.id).second) << marker.ns << marker.id;
    EXPECT_TRUE(marker.type != Marker::TRIANGLE_LIST || marker.points.size() % 3 == 0);
    if (marker.type != Marker::ARROW || marker.action != Marker::ADD) continue;
    EXPECT_LT(marker.points[1].z, marker.points[0].z);  // the force on the tissue points down
  }
}

TEST(SceneMarkers, ArrowsVanishWhenTheContactIsLost) {
  Simulator simulator = makeSimulator();
  SceneMarkers markers(simulator, MarkerStyle());
  simulator.advance(0.1, {Vector3(0, 0, -0.005)});
  const int arrows = countByNamespace(markers.update(kSecond), Marker::ADD).at("contact_forces");
  ASSERT_GT(arrows, 0);
  simulator.advance(0.2, {Vector3(0, 0, 0.02)});
  EXPECT_EQ(countByNamespace(markers.update(kSecond), Marker::DELETE).at("contact_forces"), arrows);
  EXPECT_EQ(countByNamespace(markers.update(kSecond), Marker::DELETE).count("contact_forces"), 0U);
}

TEST(SceneMarkers, RefuseAStyleThatCannotBeDrawn) {
  const Simulator simulator = makeSimulator();
  for (const double bad : {0.0, -1.0, std::numeric_limits<double>::quiet_NaN()}) {
    EXPECT_THROW(SceneMarkers(simulator, MarkerStyle{bad, 0.1}), std::invalid_argument) << bad;
    EXPECT_THROW(SceneMarkers(simulator, MarkerStyle{0.005, bad}), std::invalid_argument) << bad;
  }
}

TEST(DisplacementColor, FallsInLightnessAndStaysInRange) {
  double last = 2.0;
  for (int i = 0; i <= 100; ++i) {
    const std_msgs::ColorRGBA c = displacementColor(i / 100.0);
    const double lightness = 0.2126 * c.r + 0.7152 * c.g + 0.0722 * c.b;
    EXPECT_LT(lightness, last);
    last = lightness;
    EXPECT_EQ(c.a, 1.0F);
  }
  EXPECT_EQ(displacementColor(7.0), displacementColor(1.0));
  EXPECT_EQ(displacementColor(-1.0), displacementColor(0.0));
  EXPECT_EQ(displacementColor(std::numeric_limits<double>::quiet_NaN()), displacementColor(0.0));
}

TEST(Conversions, StampsKeepEveryNanosecond) {
  sensor_msgs::JointState message;
  message.header.stamp = ros::Time(1644257420, 444057563);
  message.name = {"a"};
  message.position = {1.5};
  const JointStateSample sample = toSample(message);
  EXPECT_EQ(sample.stamp_ns, 1644257420444057563);
  EXPECT_EQ(sample.names, message.name);
  EXPECT_EQ(sample.positions, message.position);
  EXPECT_EQ(toTime(sample.stamp_ns), message.header.stamp);
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

}  // namespace
}  // namespace tissue_contact
