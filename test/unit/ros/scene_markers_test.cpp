/// @file
/// Markers of a scene: what RViz gets, without RViz.
#include "ros/publish/scene_markers.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <memory>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "ros/conversions.h"
#include "serialized.h"
#include "support/replaced.h"
#include "support/text_scene.h"

namespace tissue_contact {
namespace scene_markers_test {

using visualization_msgs::Marker;

constexpr std::int64_t kSecond = 1000000000;

Simulator makeScene() {
  return makeSimulator("world_frame: room\n" + blockScene() + "instruments:\n" +
                       probeEntry("probe", "/probe", "[0, 0, 0.026]") +
                       "friction: [{instrument: probe, tissue: block, static: 0.5, kinetic: 0.4}]\n");
}

SceneSnapshot snapshotOf(const Simulator& simulator, std::int64_t stamp_ns) {
  SceneSnapshot snapshot;
  snapshot.markers = true;
  std::vector<ShownMesh> meshes = shownMeshes(simulator, PublishedMesh::kRefined);
  takeSnapshot(simulator, meshes, stamp_ns, snapshot);
  return snapshot;
}

std::map<std::string, int> countByNamespace(const visualization_msgs::MarkerArray& array, int action) {
  std::map<std::string, int> count;
  for (const Marker& marker : array.markers) count[marker.ns] += static_cast<int>(marker.action == action);
  return count;
}

TEST(SceneMarkers, ShowTissueToolAndForcesInTheWorldFrame) {
  Simulator simulator = makeScene();
  SceneMarkers markers(simulator, MarkerStyle());
  const auto rest = countByNamespace(markers.update(snapshotOf(simulator, kSecond)), Marker::ADD);
  EXPECT_EQ(rest.at("block"), 2);  // triangles and edges
  EXPECT_EQ(rest.at("probe"), 2);  // ball and stem
  EXPECT_EQ(rest.count("contact_forces"), 0U);

  simulator.advance(0.1, {Vector3(0, 0, -0.005)});
  const visualization_msgs::MarkerArray& pressed = markers.update(snapshotOf(simulator, 2 * kSecond));
  EXPECT_GT(countByNamespace(pressed, Marker::ADD).at("contact_forces"), 0);
  std::set<std::pair<std::string, int>> ids;
  for (const Marker& marker : pressed.markers) {
    EXPECT_EQ(marker.header.frame_id, "room");
    EXPECT_EQ(marker.header.stamp, ros::Time(2, 0));
    EXPECT_TRUE(ids.emplace(marker.ns, marker.id).second) << marker.ns << marker.id;
    EXPECT_TRUE(marker.type != Marker::TRIANGLE_LIST || marker.points.size() % 3 == 0);
  }
}

TEST(SceneMarkers, MeshesThatDoNotTouchAreLeftToRViz) {
  const auto resourceFor = [](const std::string& file) {
    const std::string urdf =
        replaced(probeUrdf(0.005), "<link name='x_link'/>",
                 "<link name='x_link'><visual><geometry><mesh filename='" + file + "'/></geometry></visual></link>");
    Simulator simulator =
        makeSimulator(blockScene() + onlyBall("[0, 0, 0.026]") +
                          "friction: [{instrument: probe, tissue: block, static: 0.5, kinetic: 0.4}]\n",
                      {{"probe", urdf}});
    SceneMarkers markers(simulator, MarkerStyle());
    for (const Marker& marker : markers.update(snapshotOf(simulator, kSecond)).markers) {
      if (marker.type == Marker::MESH_RESOURCE) return marker.mesh_resource;
    }
    return std::string();
  };
  EXPECT_EQ(resourceFor("file:///opt/my arm/link.stl"), "file:///opt/my%20arm/link.stl");
  EXPECT_EQ(resourceFor("package://not_here/link.stl"), "package://not_here/link.stl");
}

TEST(SceneMarkers, ArrowsAreTheForcesOnTheInstrumentFromTheContactPoints) {
  Simulator simulator = makeScene();
  MarkerStyle style;
  style.force_arrow_m_per_n = 0.5;
  SceneMarkers markers(simulator, style);
  simulator.advance(0.1, {Vector3(0, 0, -0.005)});
  std::vector<const SolvedContact*> pressing;
  for (const SolvedContact& contact : simulator.contacts()) {
    if (contact.state != ContactState::kOpen && contact.force_on_tissue_n.norm() > 0.0) pressing.push_back(&contact);
  }
  ASSERT_FALSE(pressing.empty());
  std::size_t arrows = 0;
  Vector3 sum = Vector3::Zero();
  for (const Marker& marker : markers.update(snapshotOf(simulator, kSecond)).markers) {
    if (marker.ns != "contact_forces" || marker.action != Marker::ADD) continue;
    ASSERT_LT(arrows, pressing.size());
    const SolvedContact& contact = *pressing[arrows++];
    const Vector3 from(marker.points[0].x, marker.points[0].y, marker.points[0].z);
    const Vector3 to(marker.points[1].x, marker.points[1].y, marker.points[1].z);
    EXPECT_EQ(from, contact.contact.p_WC);
    EXPECT_LE(((to - from) / 0.5 + contact.force_on_tissue_n).norm(), 1e-12);
    sum += (to - from) / 0.5;
  }
  EXPECT_EQ(arrows, pressing.size());
  EXPECT_GT(sum.z(), 0.01);                                    // the pressed tissue pushes the probe up
  EXPECT_LE((sum - simulator.wrench(0).force).norm(), 1e-12);  // the tip keeps the world's axes
}

TEST(SceneMarkers, ArrowsVanishWhenTheContactIsLost) {
  Simulator simulator = makeScene();
  SceneMarkers markers(simulator, MarkerStyle());
  simulator.advance(0.1, {Vector3(0, 0, -0.005)});
  const int arrows = countByNamespace(markers.update(snapshotOf(simulator, kSecond)), Marker::ADD).at("contact_forces");
  ASSERT_GT(arrows, 0);
  simulator.advance(0.2, {Vector3(0, 0, 0.02)});
  EXPECT_EQ(countByNamespace(markers.update(snapshotOf(simulator, kSecond)), Marker::DELETE).at("contact_forces"),
            arrows);
  EXPECT_EQ(countByNamespace(markers.update(snapshotOf(simulator, kSecond)), Marker::DELETE).count("contact_forces"),
            0U);
}

/// A snapshot with another mesh of the block, at rest.
void changeMesh(SceneSnapshot& snapshot, const std::string& cells, int revision) {
  const Simulator other = makeSimulator(blockScene("[0.06, 0.06, 0.02]", cells));
  snapshot.revisions = {std::make_shared<MeshRevision>(other.tissues()[0], revision)};
  snapshot.positions = {other.tissues()[0].restPositions()};
}

TEST(SceneMarkers, FollowTheMeshOfTheSnapshot) {
  const Simulator simulator = makeScene();
  SceneMarkers markers(simulator, MarkerStyle());
  SceneSnapshot snapshot = snapshotOf(simulator, kSecond);
  int revision = 0;
  for (const char* cells : {"[4, 4, 2]", "[7, 5, 4]", "[2, 3, 1]", "[7, 5, 4]"}) {
    changeMesh(snapshot, cells, revision++);
    const visualization_msgs::MarkerArray& shown = markers.update(snapshot);
    const MeshRevision& mesh = *snapshot.revisions[0];
    const Marker& triangles = shown.markers[0];
    ASSERT_EQ(triangles.points.size(), 3 * mesh.surface.size());
    ASSERT_EQ(triangles.colors.size(), triangles.points.size());
    EXPECT_EQ(shown.markers[1].points.size(), 2 * mesh.surface.size() * 3 / 2);  // closed: two triangles share an edge
    for (std::size_t i = 0; i < triangles.points.size(); ++i) {
      const geometry_msgs::Point corner = toPoint(mesh.rest_positions.col(mesh.surface[i / 3][i % 3]));
      EXPECT_EQ(serialized(triangles.points[i]), serialized(corner));
      EXPECT_GT(triangles.colors[i].r, 0.5F);  // not displaced: light, whatever the mesh before
    }
  }
}

const Marker& markerOf(const visualization_msgs::MarkerArray& array, const std::string& ns, int id) {
  for (const Marker& marker : array.markers) {
    if (marker.ns == ns && marker.id == id) return marker;
  }
  throw std::out_of_range(ns);
}

/// Texts of the legend, as they lie in the array: title, states, numbers beside the bar from 0 up, force of the arrow.
std::vector<std::string> legendTexts(const visualization_msgs::MarkerArray& array) {
  std::vector<std::string> texts;
  for (const Marker& marker : array.markers) {
    if (marker.ns == "legend" && marker.type == Marker::TEXT_VIEW_FACING) texts.push_back(marker.text);
  }
  return texts;
}

TEST(SceneMarkers, TheForceStandsAtTheTipInTheColorOfItsState) {
  Simulator simulator = makeScene();
  SceneMarkers markers(simulator, MarkerStyle());
  EXPECT_EQ(markerOf(markers.update(snapshotOf(simulator, kSecond)), "force_texts", 0).text, "0.000 N");
  simulator.advance(0.1, {Vector3(0, 0, -0.005)});
  const Marker& text = markerOf(markers.update(snapshotOf(simulator, kSecond)), "force_texts", 0);
  EXPECT_EQ(text.text, forceText(simulator.wrench(0).force.norm()));
  EXPECT_NE(text.text, "0.000 N");
  double held_n = 0.0;
  double slides_n = 0.0;
  for (const SolvedContact& contact : simulator.contacts()) {
    if (contact.state == ContactState::kStatic) held_n += contact.force_on_tissue_n.norm();
    if (contact.state == ContactState::kKinetic) slides_n += contact.force_on_tissue_n.norm();
  }
  ASSERT_NE(held_n, slides_n);
  EXPECT_EQ(serialized(text.color), serialized(slides_n > held_n ? kineticColor() : staticColor()));
  const Vector3 tip =
      simulator.linkPoses(0)[static_cast<std::size_t>(simulator.instruments()[0].tipLink())].translation();
  const double away = (Vector3(text.pose.position.x, text.pose.position.y, text.pose.position.z) - tip).norm();
  EXPECT_LT(away, 0.5 * pictureFrame(simulator).size());
}

// Seen as open_rviz.py looks at it, with the probe above the block and, where gravity points up, below it.
TEST(SceneMarkers, TheBlockDoesNotHideTheForce) {
  const Eigen::AlignedBox3d block(Vector3(-0.03, -0.03, 0.0), Vector3(0.03, 0.03, 0.02));
  for (const double gravity : {-9.81, 9.81}) {
    Scene scene = makeScene().scene();
    scene.gravity_m_per_s2 = Vector3(0, 0, gravity);
    const Simulator simulator(scene, ownEnvironment());
    const PictureFrame frame = pictureFrame(simulator);
    SceneMarkers markers(simulator, MarkerStyle());
    const Marker& text = markerOf(markers.update(snapshotOf(simulator, kSecond)), "force_texts", 0);
    const Vector3 middle(text.pose.position.x, text.pose.position.y, text.pose.position.z);
    const Vector3 foot = middle - 0.5 * text.scale.z * frame.upwards();
    const Vector3 tip(0.0, 0.0, 0.026);
    EXPECT_LT((middle - tip).norm(), 0.5 * frame.size());
    const Vector3 to_viewer = std::cos(0.45) * Vector3(std::cos(frame.azimuth), std::sin(frame.azimuth), 0.0) +
                              std::sin(0.45) * frame.upwards();
    for (const double end : {-1.0, 0.0, 1.0}) {
      for (double way_m = 0.0; way_m < 0.2; way_m += 0.0005) {
        ASSERT_FALSE(block.contains(foot + 1.2 * end * frame.halfWidth(text.text) + way_m * to_viewer)) << gravity;
      }
    }
  }
}

TEST(SceneMarkers, ScalesFitWhatIsDrawnAndNeverShrink) {
  Simulator simulator = makeScene();
  SceneMarkers markers(simulator, MarkerStyle());
  const PictureFrame frame = pictureFrame(simulator);
  double last_mm = 0.0;
  for (const double depth : {0.002, 0.006, 0.012, 0.012, 0.003, 0.0}) {
    simulator.advance(0.1, {Vector3(0, 0, -depth)});
    const visualization_msgs::MarkerArray& shown = markers.update(snapshotOf(simulator, kSecond));
    const double full_mm = std::stod(legendTexts(shown).at(5));
    const double deepest_mm =
        1e3 * (simulator.positions(0) - simulator.tissues()[0].restPositions()).colwise().norm().maxCoeff();
    EXPECT_LE(deepest_mm, full_mm);
    EXPECT_GE(full_mm, last_mm);
    last_mm = full_mm;
    for (const Marker& marker : shown.markers) {
      if (marker.ns != "contact_forces" || marker.action != Marker::ADD) continue;
      const Vector3 arrow(marker.points[1].x - marker.points[0].x, marker.points[1].y - marker.points[0].y,
                          marker.points[1].z - marker.points[0].z);
      EXPECT_LE(arrow.norm(), frame.longestArrow() * (1.0 + 1e-9));
    }
  }
  EXPECT_GT(last_mm, 6.0);
  EXPECT_LT(last_mm, 20.0);
}

// A small tool on a large organ: what presses there is small for the organ and is to be seen all the same.
TEST(SceneMarkers, ArrowsAreSeenOnLargeTissue) {
  Simulator simulator = makeSimulator(blockScene("[0.3, 0.3, 0.1]", "[6, 6, 2]") + "instruments:\n" +
                                      probeEntry("probe", "/probe", "[0, 0, 0.1055]"));
  SceneMarkers markers(simulator, MarkerStyle());
  simulator.advance(0.1, {Vector3(0, 0, -0.0007)});
  double longest_m = 0.0;
  for (const Marker& marker : markers.update(snapshotOf(simulator, kSecond)).markers) {
    if (marker.ns != "contact_forces" || marker.action != Marker::ADD) continue;
    longest_m =
        std::max(longest_m, std::hypot(marker.points[1].x - marker.points[0].x, marker.points[1].y - marker.points[0].y,
                                       marker.points[1].z - marker.points[0].z));
  }
  EXPECT_GT(longest_m, 0.2 * pictureFrame(simulator).longestArrow());
}

TEST(SceneMarkers, GivenScalesStay) {
  Simulator simulator = makeScene();
  MarkerStyle style;
  style.color_full_scale = 0.0035;
  style.force_arrow_m_per_n = 0.2;
  SceneMarkers markers(simulator, style);
  for (const double depth : {0.002, 0.012}) {
    simulator.advance(0.1, {Vector3(0, 0, -depth)});
    const visualization_msgs::MarkerArray& shown = markers.update(snapshotOf(simulator, kSecond));
    const std::vector<std::string> texts = legendTexts(shown);
    EXPECT_EQ(texts, (std::vector<std::string>{"displacement, mm", "kinetic: slides", "static: held", "0", "1.75",
                                               "3.5", texts.back()}));
    const Marker& arrow = *std::find_if(shown.markers.begin(), shown.markers.end(), [](const Marker& marker) {
      return marker.ns == "legend" && marker.type == Marker::ARROW;
    });
    EXPECT_NEAR(arrow.points[1].z - arrow.points[0].z, 0.2 * std::stod(texts.back()), 1e-12);  // "0.08 N"
  }
}

TEST(SceneMarkers, PressureIsUnderTheToolAndStrainAround) {
  Simulator simulator = makeScene();
  simulator.advance(0.1, {Vector3(0, 0, -0.006)});
  for (const auto& [color, title] : {std::pair(SurfaceColor::kPressure, "contact pressure, kPa"),
                                     std::pair(SurfaceColor::kStrain, "equivalent strain, %")}) {
    MarkerStyle style;
    style.color = color;
    SceneMarkers markers(simulator, style);
    const visualization_msgs::MarkerArray& shown = markers.update(snapshotOf(simulator, kSecond));
    EXPECT_EQ(legendTexts(shown).front(), title);
    const Marker& surface = shown.markers[0];
    int darker = 0;
    for (std::size_t i = 0; i < surface.points.size(); ++i) {
      const double aside = std::hypot(surface.points[i].x, surface.points[i].y);
      const bool is_dark = surface.colors[i].g < 0.6F * surface.colors[i].r;
      darker += static_cast<int>(is_dark);
      EXPECT_LT(is_dark ? aside : 0.0, 0.025) << title;  // within the cells of 15 mm around a ball of 5 mm
    }
    EXPECT_GT(darker, 0) << title;
  }
}

TEST(SceneMarkers, TheLegendStandsUprightBesideTheTissue) {
  for (const double gravity : {-9.81, 9.81}) {
    Scene scene = makeScene().scene();
    scene.gravity_m_per_s2 = Vector3(0, 0, gravity);
    const Simulator simulator(scene, ownEnvironment());
    const PictureFrame frame = pictureFrame(simulator);
    EXPECT_EQ(frame.up, gravity < 0.0 ? 1.0 : -1.0);
    SceneMarkers markers(simulator, MarkerStyle());
    for (const Marker& marker : markers.update(snapshotOf(simulator, kSecond)).markers) {
      if (marker.ns != "legend") continue;
      std::vector<geometry_msgs::Point> points = marker.points;
      if (points.empty()) points.push_back(marker.pose.position);
      EXPECT_GE(frame.up * (points.back().z - points.front().z), 0.0);
      for (const geometry_msgs::Point& p : points) {
        const Vector3 from_middle = Vector3(p.x, p.y, 0.0) - 0.5 * (frame.low + frame.high);
        EXPECT_GT(from_middle.dot(frame.rightwards()), 0.03);
        EXPECT_LT(from_middle.norm(), 2.0 * frame.size());
      }
    }
  }
}

TEST(PictureFrame, IsLookedAtFromTheSideOfTipsThatAreBeside) {
  const Simulator simulator = makeSimulator("world_frame: room\n" + blockScene() + "instruments:\n" +
                                            probeEntry("probe", "/probe", "[0.2, 0.1, 0.026]"));
  const PictureFrame frame = pictureFrame(simulator);
  const Vector3 to_camera(std::cos(frame.azimuth), std::sin(frame.azimuth), 0.0);
  const Vector3 to_tip = Vector3(0.2, 0.1, 0.0).normalized();
  EXPECT_GT(to_camera.dot(to_tip), 0.7);
  EXPECT_LT(frame.rightwards().dot(to_tip), -0.6);
  EXPECT_NEAR(frame.rightwards().dot(to_camera), 0.0, 1e-12);
}

TEST(FullScale, IsRoundAndGrowsAsFarAsIsBelieved) {
  for (const auto& [value, up] : {std::pair(1.0, 1.0), std::pair(1.01, 1.5), std::pair(0.0021, 0.003),
                                  std::pair(73.0, 80.0), std::pair(0.91, 1.0), std::pair(4e-9, 4e-9)}) {
    EXPECT_NEAR(roundUp(value), up, 1e-12 * up) << value;
  }
  FullScale scale(0.0, 0.9, 50.0);
  EXPECT_EQ(scale.value(), 1.0);
  scale.take(std::numeric_limits<double>::quiet_NaN());
  scale.take(0.5);
  EXPECT_EQ(scale.value(), 1.0);
  scale.take(7.0);
  EXPECT_EQ(scale.value(), 8.0);
  scale.take(std::numeric_limits<double>::infinity());
  EXPECT_EQ(scale.value(), 60.0);
  scale.take(1e9);
  EXPECT_EQ(scale.value(), 60.0);
  FullScale given(0.07, 1.0, 50.0);
  given.take(2.0);
  EXPECT_EQ(given.value(), 0.07);
}

TEST(SurfaceColor, UnknownNamesAreRefused) {
  EXPECT_EQ(toSurfaceColor("p", "strain"), SurfaceColor::kStrain);
  for (const char* bad : {"", "Strain", "stress", "0"}) {
    EXPECT_THROW(toSurfaceColor("parameter 'p'", bad), std::invalid_argument) << bad;
  }
}

TEST(ForceText, HasThreeDigitsAsARule) {
  EXPECT_EQ(forceText(0.0), "0.000 N");
  EXPECT_EQ(forceText(0.0444), "0.044 N");
  EXPECT_EQ(forceText(0.8351), "0.84 N");
  EXPECT_EQ(forceText(12.34), "12.3 N");
}

TEST(ScaleColor, FallsInLightnessAndStaysInRange) {
  double last = 2.0;
  for (int i = 0; i <= 100; ++i) {
    const std_msgs::ColorRGBA c = scaleColor(i / 100.0);
    const double lightness = 0.2126 * c.r + 0.7152 * c.g + 0.0722 * c.b;
    EXPECT_LT(lightness, last);
    last = lightness;
    EXPECT_EQ(c.a, 1.0F);
  }
  EXPECT_EQ(serialized(scaleColor(7.0)), serialized(scaleColor(1.0)));
  EXPECT_EQ(serialized(scaleColor(-1.0)), serialized(scaleColor(0.0)));
  EXPECT_EQ(serialized(scaleColor(std::numeric_limits<double>::quiet_NaN())), serialized(scaleColor(0.0)));
}

}  // namespace scene_markers_test
}  // namespace tissue_contact
