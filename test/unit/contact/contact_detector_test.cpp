// The detector over whole instruments and tissues; shape sizes.
#include "tissue_contact/contact/contact_detector.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>
#include <string>

#include "contact_test_utilities.h"
#include "support/temporary_directory.h"

namespace tissue_contact::contact_test {
namespace contact_detector_test {

ShapeDescription sphere(double radius, const Vector3& p) { return {SphereGeometry{radius}, at(p)}; }

ShapeDescription box(const Vector3& size, const Vector3& p) { return {BoxGeometry{size}, at(p)}; }

struct TwoByTwo {
  std::vector<Instrument> instruments;
  std::vector<TissueSurface> surfaces;
  std::vector<NodalVectors> positions;
  std::vector<std::vector<Pose>> X_WL;
};

std::string wavefront(const TriangleMesh& mesh) {
  std::ostringstream text;
  for (const auto& vertex : mesh.vertices.colwise()) text << "v " << vertex.transpose() << '\n';
  for (const Triangle& t : mesh.triangles) text << "f " << t[0] + 1 << ' ' << t[1] + 1 << ' ' << t[2] + 1 << '\n';
  return text.str();
}

/// Two blocks side by side, 20 mm apart, and two probes of two spheres each over both.
TwoByTwo makeScene() {
  TwoByTwo scene;
  const Surface block = boxSurface({0.04, 0.04, 0.02}, {8, 8, 3});
  for (const double x : {0.0, 0.06}) {
    NodalVectors nodes = block.nodes;
    nodes.row(0).array() += x;
    scene.surfaces.push_back({block.triangles, block.fixed()});
    scene.positions.push_back(nodes);
  }
  for (const double y : {0.0103, 0.0309}) {
    const std::string name = y < 0.02 ? "left" : "right";
    std::vector<ShapeDescription> shapes;  // one by one: GCC 12 warns falsely of freeing where a list of variants ends
    shapes.push_back(sphere(0.005, {0.0211, y, 0.0}));
    shapes.push_back(box({0.012, 0.008, 0.01}, {0.0803, y, 0.0}));
    scene.instruments.push_back(makeInstrument(name, shapes));
    scene.X_WL.push_back({Pose::Identity(), at({0.0, 0.0, 0.0245})});
  }
  return scene;
}

/// Every triangle of every tissue, by brute force.
double slowApproach(const TwoByTwo& scene, int instrument) {
  double nearest = std::numeric_limits<double>::infinity();
  for (const CollisionShape& shape : scene.instruments[instrument].contactLinks()[0].shapes) {
    const Pose X_SW = (scene.X_WL[instrument][1] * shape.X_LS).inverse();
    const auto distance = ShapeDistances({}).make(shape);
    for (std::size_t tissue = 0; tissue < scene.surfaces.size(); ++tissue) {
      const NodalVectors& x = scene.positions[tissue];
      for (const Triangle& t : scene.surfaces[tissue].triangles) {
        const TrianglePoints points(X_SW * Vector3(x.col(t[0])), X_SW * Vector3(x.col(t[1])),
                                    X_SW * Vector3(x.col(t[2])));
        nearest = std::min(nearest, bruteForceMinimum(*distance, points));
      }
    }
  }
  return nearest;
}

TEST(ContactDetector, ClosestApproachIsExactAtAnyDistance) {
  TwoByTwo scene = makeScene();
  ContactDetector detector(scene.instruments, shareSurfaces(scene.surfaces, scene.positions));
  Random random(7);
  for (int trial = 0; trial < 4; ++trial) {
    for (std::vector<Pose>& poses : scene.X_WL) {
      poses[1] = random.pose(trial % 2 == 0 ? 0.03 : 1.0);
      poses[1].translation().z() += trial % 2 == 0 ? 0.06 : 3.0;
    }
    Approach closest;
    detector.lowerClosestApproach(scene.positions, scene.X_WL, closest);
    const double expected = std::min(slowApproach(scene, 0), slowApproach(scene, 1));
    EXPECT_NEAR(closest.distance_m, expected, 1e-8) << trial;  // what the slow search leaves
    ASSERT_GE(closest.instrument, 0);
    EXPECT_NEAR(slowApproach(scene, closest.instrument), expected, 1e-8) << trial;
  }
}

/// Where the nearest point is a node: on a domed block below the middle of a shape, whatever that is and however it turns.
TEST(ContactDetector, TheNearestPlaceIsWhereTheSurfaceIsNearest) {
  const TemporaryDirectory folder;
  const auto meshShape = [&](const std::string& name, const TriangleMesh& mesh) -> ShapeDescription {
    return {MeshGeometry{folder.write(name, wavefront(mesh))}, Pose::Identity()};
  };
  std::vector<ShapeDescription> shapes;
  shapes.push_back(sphere(0.005, Vector3::Zero()));
  shapes.push_back({CylinderGeometry{0.004, 0.02}, Pose::Identity()});
  shapes.push_back(box({0.008, 0.006, 0.02}, Vector3::Zero()));
  shapes.push_back(meshShape("ball.obj", sphereMesh(0.005, 3)));
  shapes.push_back(meshShape("bar.obj", boxMesh({0.004, 0.003, 0.01}, 4)));
  Random random(5);
  for (std::size_t s = 0; s < shapes.size(); ++s) {
    std::vector<Instrument> instruments;
    instruments.push_back(makeInstrument("tool", {shapes[s]}));
    const CollisionShape& shape = instruments[0].contactLinks()[0].shapes[0];
    const auto distance = ShapeDistances({}).make(shape);
    for (const double dome : {0.0, 1e-12, 1e-9, 1e-6, 1e-3, 1e-2}) {
      Surface block = boxSurface({0.04, 0.04, 0.02}, {8, 8, 3});
      const Vector3 top(0.02, 0.02, 0.02);
      for (int i = 0; i < block.nodes.cols(); ++i) {
        const Vector3 p = block.nodes.col(i);
        if (p.z() > 0.0199) block.nodes(2, i) += dome * std::exp(-(p - top).squaredNorm() / 1e-4);
      }
      const std::vector<NodalVectors> positions = {block.nodes};
      ContactDetector detector(instruments, shareSurfaces({{block.triangles, block.fixed()}}, positions));
      for (int trial = 0; trial < 4; ++trial) {
        Pose X_WL = at({0.02, 0.02, 0.045 + dome + 0.002 * trial});
        if (trial > 1) X_WL.rotate(Eigen::AngleAxisd(random.number(-3.0, 3.0), random.direction()));
        SCOPED_TRACE(testing::Message() << "shape " << s << ", dome " << dome << ", trial " << trial);
        const std::vector<std::vector<Pose>> poses = {{Pose::Identity(), X_WL}};
        std::vector<NearPlace> near;
        detector.findNear(positions, poses, {0.1}, near);
        ASSERT_EQ(near.size(), 1u);
        Vector3 place = Vector3::Zero();
        for (int i = 0; i < 3; ++i) place += near[0].weights[i] * block.nodes.col(near[0].nodes[i]);
        EXPECT_NEAR(distance->at(X_WL.inverse() * place).distance, near[0].distance_m, 1e-5);
        Approach closest;
        detector.lowerClosestApproach(positions, poses, closest);
        double least = std::numeric_limits<double>::infinity();  // of the nodes
        for (const auto& x : block.nodes.colwise()) {
          least = std::min(least, distance->atAnyDistance(X_WL.inverse() * Vector3(x)).distance);
        }
        // Of meshes at the place where a lower bound of the distance is least.
        const bool is_mesh = std::holds_alternative<MeshGeometry>(shapes[s].geometry);
        EXPECT_LT(closest.distance_m, least + (is_mesh ? 2e-3 : 1e-9));
        const Pose touching = at(closest.distance_m * closest.normal_W) * X_WL;
        EXPECT_NEAR(distance->at(touching.inverse() * closest.p_W).distance, 0.0, 1e-5 + distance->edgeRadius());
      }
    }
  }
}

TEST(ContactDetector, ClosestApproachOnlyFallsAndNamesThePair) {
  TwoByTwo scene = makeScene();
  ContactDetector detector(scene.instruments, shareSurfaces(scene.surfaces, scene.positions));
  for (std::vector<Pose>& poses : scene.X_WL) poses[1] = at({0.0, 0.0, 0.1});
  scene.X_WL[1][1] = at({0.0, 0.0, 0.03});  // the box's lower face is 5 mm below, the tissues' upper face at 20 mm
  Approach closest;
  detector.lowerClosestApproach(scene.positions, scene.X_WL, closest);
  EXPECT_NEAR(closest.distance_m, 0.005, 1e-12);
  EXPECT_EQ(closest.instrument, 1);
  EXPECT_EQ(closest.link, 0);
  const Approach before = closest;
  for (std::vector<Pose>& poses : scene.X_WL) poses[1] = at({0.0, 0.0, 0.031});
  detector.lowerClosestApproach(scene.positions, scene.X_WL, closest);
  EXPECT_EQ(closest.distance_m, before.distance_m);
  scene.X_WL[0][1] = at({0.02, 0.0, 0.024});  // now the left one's box, over the right tissue
  detector.lowerClosestApproach(scene.positions, scene.X_WL, closest);
  EXPECT_LT(closest.distance_m, before.distance_m);
  EXPECT_EQ(closest.instrument, 0);
}

TEST(ContactDetector, ClosestApproachCountsTheThicknessOfASheet) {
  TwoByTwo scene = makeScene();
  for (TissueSurface& surface : scene.surfaces) surface.thickness_m = 0.002;
  for (std::vector<Pose>& poses : scene.X_WL) poses[1] = at({0.0, 0.0, 0.03});
  ContactDetector detector(scene.instruments, shareSurfaces(scene.surfaces, scene.positions));
  Approach closest;
  detector.lowerClosestApproach(scene.positions, scene.X_WL, closest);
  EXPECT_NEAR(closest.distance_m, 0.004, 1e-12);
}

TEST(ContactDetector, NamesTissueInstrumentLinkAndShape) {
  TwoByTwo scene = makeScene();
  ContactDetector detector(scene.instruments, shareSurfaces(scene.surfaces, scene.positions));
  std::vector<Contact> contacts;
  detector.detect(scene.positions, scene.X_WL, 1e-3, contacts);
  std::array<std::array<int, 2>, 2> count{};
  for (std::size_t i = 0; i < contacts.size(); ++i) {
    const Contact& c = contacts[i];
    if (i > 0) {
      EXPECT_TRUE(contacts[i - 1].key < c.key);
    }
    EXPECT_EQ(c.key.link, 0);
    EXPECT_EQ(c.key.shape, c.key.tissue);  // the sphere is over the first block, the box over the second
    ++count[c.key.tissue][c.key.instrument];
    EXPECT_EQ(pointOf(scene.positions[c.key.tissue], c.nodes, c.weights), c.p_WC);
    EXPECT_NEAR(c.R_WC.determinant(), 1.0, 1e-12);
    const bool over_own = std::abs(c.p_WC.y() - (c.key.instrument == 0 ? 0.0103 : 0.0309)) < 0.006;
    EXPECT_TRUE(over_own);
  }
  for (const auto& row : count) {
    for (const int n : row) EXPECT_GT(n, 0);
  }
  ASSERT_FALSE(contacts.empty());
  // The sphere presses by 0.5 mm from above.
  const auto deepest = std::min_element(contacts.begin(), contacts.end(),
                                        [](const Contact& a, const Contact& b) { return a.gap_m < b.gap_m; });
  EXPECT_NEAR(deepest->gap_m, -5e-4, 1e-15);
  EXPECT_LT((deepest->R_WC.col(0) + Vector3::UnitZ()).norm(), 1e-12);
}

TEST(ContactDetector, LinkAndShapePosesPlaceTheShape) {
  const Surface block = boxSurface({0.04, 0.04, 0.02}, {4, 4, 2});
  Random random(40);
  const Pose X_LS = random.pose(0.02);
  std::vector<Instrument> instruments;
  instruments.push_back(makeInstrument("probe", {{CylinderGeometry{0.003, 0.02}, X_LS}}));
  // The cylinder's flat end on the block: its middle 10 mm above the surface, axis up.
  const Pose X_WS = at({0.0211, 0.0193, 0.02 + 0.01 + 1e-4});
  ContactDetector detector(instruments, shareSurfaces({{block.triangles, block.fixed()}}, {block.nodes}));
  std::vector<Contact> contacts;
  detector.detect({block.nodes}, {{Pose::Identity(), X_WS * X_LS.inverse()}}, 5e-4, contacts);
  ASSERT_FALSE(contacts.empty());
  for (const Contact& c : contacts) {
    EXPECT_NEAR(c.gap_m, 1e-4, 1e-15);
    EXPECT_LT((c.R_WC.col(0) + Vector3::UnitZ()).norm(), 1e-12);
  }
}

// A ball at the origin of its link: all has a closed form.
TEST(ContactDetector, FramesTurnWithASlideOverABall) {
  const TwoByTwo scene = makeScene();
  std::vector<Instrument> instruments;
  instruments.push_back(makeInstrument("ball", {sphere(0.005, Vector3::Zero())}));
  const ContactDetector detector(instruments, shareSurfaces(scene.surfaces, scene.positions));
  Contact contact;
  contact.key = {0, 0, 0, 0, {0, -1, -1}};
  const Vector3 p(0.003, 0.0, -0.0039);
  const double gap = p.norm() - 0.005;
  const auto turned = [&](const Vector3& to, const Pose& end) {
    contact.p_WC = p;
    contact.R_WC = contactFrame(p.normalized());
    contact.gap_m = gap;
    detector.turnWithSlide({{Pose::Identity(), Pose::Identity()}}, {{Pose::Identity(), end}}, to - p, contact);
    EXPECT_LT((contact.R_WC.transpose() * contact.R_WC - Matrix3::Identity()).norm(), 1e-14);
    return contact.R_WC.col(0);
  };
  const Vector3 along = Vector3(0.39, 0.1, 0.3).normalized();  // across p
  ASSERT_NEAR(along.dot(p), 0.0, 1e-17);
  const Vector3 q = p + 4e-4 * along;
  EXPECT_LT((turned(q, Pose::Identity()) - q.normalized()).norm(), 1e-14);
  EXPECT_NEAR(contact.gap_m + contact.R_WC.col(0).dot(q - p), q.norm() - 0.005, 1e-17) << "the gap there, of the frame";
  EXPECT_LT((contact.R_WC.col(1) - contactFrame(p.normalized()).col(1)).norm(), 0.1) << "turns with it";
  // What moves towards the ball does not slide; the tool may move as well, or in its place.
  EXPECT_LT((turned(q - 1e-3 * p.normalized(), Pose::Identity()) - q.normalized()).norm(), 1e-14);
  EXPECT_LT((turned(p, at(p - q)) - q.normalized()).norm(), 1e-14);
  EXPECT_LT((turned(q, at(q - p)) - p.normalized()).norm(), 1e-14) << "both move: it sticks";
  // A ball that turns under a point is the same ball.
  const Pose spin(Eigen::AngleAxisd(0.02, Vector3(0.0, 0.6, 0.8)));
  EXPECT_LT((turned(p, spin) - p.normalized()).norm(), 1e-3 * 0.02);
  // Half of the turn where normals differ by 0.15, none from 0.2 on.
  const double half = 2.0 * std::asin(0.5 * 0.15);
  const auto at_angle = [&](double angle) { return Vector3(p + std::tan(angle) * p.norm() * along); };
  EXPECT_NEAR(std::acos(turned(at_angle(half), Pose::Identity()).dot(p.normalized())), 0.5 * half, 1e-9);
  EXPECT_EQ(turned(at_angle(0.21), Pose::Identity()), contactFrame(p.normalized()).col(0));
  EXPECT_EQ(contact.gap_m, gap);
}

// The gap at the end of the way is that of the shape, whichever way the contact presses.
TEST(ContactDetector, WhatAFrameLeansByDoesNotLeadToTheShape) {
  const TwoByTwo scene = makeScene();
  std::vector<Instrument> instruments;
  instruments.push_back(makeInstrument("ball", {sphere(0.005, Vector3::Zero())}));
  const ContactDetector detector(instruments, shareSurfaces(scene.surfaces, scene.positions));
  const std::vector<std::vector<Pose>> still = {{Pose::Identity(), Pose::Identity()}};
  const Vector3 way = 4e-4 * Vector3(0.39, 0.1, 0.3).normalized();
  for (const double tilt : {0.0, 0.05, 0.2}) {
    for (const double depth : {1e-4, 1e-3}) {  // of a slide; of what is being freed, and keeps its frame
      const Vector3 p = (0.005 - depth) * Vector3(0.3, 0.0, -0.39).normalized();  // across the way
      Contact contact;
      contact.key = {0, 0, 0, 0, {0, -1, -1}};
      contact.p_WC = p;
      const Vector3 normal = Eigen::AngleAxisd(tilt, Vector3::UnitY()) * p.normalized();
      contact.R_WC = contactFrame(normal);
      contact.lean_W = normal - p.normalized();
      contact.gap_m = -depth;
      detector.turnWithSlide(still, still, way, contact);
      const double there = contact.gap_m + contact.R_WC.col(0).dot(way);
      const double expected = depth < 5e-4 ? (p + way).norm() - 0.005 : -depth + p.normalized().dot(way);
      EXPECT_NEAR(there, expected, 1e-16) << tilt << " " << depth;
    }
  }
}

// Tissue that bulges between two balls of one instrument is pressed by the filled groove; what its vertices lean by goes on there.
TEST(ContactDetector, InAGrooveVerticesLeanAsBesideIt) {
  Surface block = boxSurface({0.04, 0.04, 0.02}, {40, 40, 4});
  for (Eigen::Index i = 0; i < block.nodes.cols(); ++i) {
    Vector3 p = block.nodes.col(i);
    p.y() += 8.0 * (p.y() - 0.02) * std::abs(p.y() - 0.02);  // triangles grow away from the middle
    if (p.z() > 0.0199) p.z() += 0.0019 * std::max(0.0, 1.0 - std::pow((p.x() - 0.02) / 0.004, 2));
    block.nodes.col(i) = p;
  }
  std::vector<ShapeDescription> shapes;
  shapes.push_back(sphere(0.005, {0.0155, 0.021, 0.024}));
  shapes.push_back(sphere(0.005, {0.0245, 0.021, 0.024}));
  std::vector<Instrument> instruments;
  instruments.push_back(makeInstrument("balls", shapes));
  ContactDetector detector(instruments, shareSurfaces({{block.triangles, block.fixed()}}, {block.nodes}));
  std::vector<Contact> contacts;
  detector.detect({block.nodes}, {{Pose::Identity(), Pose::Identity()}}, 1e-4, contacts);
  int filled = 0;
  for (const Contact& c : contacts) {
    const Vector3 gradient = c.R_WC.col(0) - c.lean_W;
    EXPECT_NEAR(gradient.norm(), 1.0, 1e-9);
    const Vector3 middle(c.key.shape == 0 ? 0.0155 : 0.0245, 0.021, 0.024);
    const bool in_groove = (gradient - (c.p_WC - middle).normalized()).norm() > 0.05;
    filled += in_groove && c.lean_W.norm() > 1e-3;
  }
  EXPECT_GT(filled, 0);
}

TEST(ContactDetector, FramesDoNotTurnAtEdgesNorOfCorners) {
  const TwoByTwo scene = makeScene();
  std::vector<Instrument> instruments;
  instruments.push_back(makeInstrument("box", {box({0.01, 0.01, 0.01}, Vector3::Zero())}));
  const ContactDetector detector(instruments, shareSurfaces(scene.surfaces, scene.positions));
  const std::vector<std::vector<Pose>> still = {{Pose::Identity(), Pose::Identity()}};
  Contact contact;
  contact.key = {0, 0, 0, 0, {0, -1, -1}};
  contact.p_WC = {0.0, 0.0049, -0.0051};
  contact.R_WC = contactFrame(-Vector3::UnitZ());
  contact.gap_m = 1e-4;
  const Contact before = contact;
  const auto unchanged = [&] { return contact.R_WC == before.R_WC && contact.gap_m == before.gap_m; };
  for (const double y : {0.0, 0.0049, 0.006}) {  // over the face, and past its edge
    detector.turnWithSlide(still, still, {0.0, y - 0.0049, 0.0}, contact);
    EXPECT_LT((contact.R_WC - before.R_WC).norm(), 1e-15) << y;
    EXPECT_NEAR(contact.gap_m, before.gap_m, 1e-17) << y;
  }
  // Beyond the edge the distance is rounded, by the gap.
  contact.p_WC = {0.0, 0.005 + 1e-6, -0.005 - 1e-6};
  contact.R_WC = contactFrame(Vector3(0.0, 1.0, -1.0).normalized());
  const Matrix3 frame = contact.R_WC;
  detector.turnWithSlide(still, still, {0.0, 1e-7, 1e-7}, contact);
  EXPECT_EQ(contact.R_WC, frame);
  contact = before;
  const Pose roll(Eigen::AngleAxisd(0.02, Vector3::UnitX()));
  contact.key.corner = 3;
  detector.turnWithSlide(still, {{Pose::Identity(), roll}}, Vector3::Zero(), contact);
  EXPECT_TRUE(unchanged()) << "the normal of a corner is the tissue's";
  contact.key.corner = -1;
  contact.p_WC.y() = 0.004;
  detector.turnWithSlide(still, {{Pose::Identity(), roll}}, Vector3::Zero(), contact);
  EXPECT_LT((contact.R_WC.col(0) + roll.linear() * Vector3::UnitZ()).norm(), 1e-14) << "a face turns with its tool";
  contact = before;
  contact.R_WC = contactFrame(-Vector3::UnitX());
  detector.turnWithSlide(still, {{Pose::Identity(), roll}}, Vector3::Zero(), contact);
  EXPECT_EQ(contact.R_WC, contactFrame(-Vector3::UnitX())) << "not the shape's own normal";
}

/// An edge of the tissue that crosses one of a box touches it there: round-off tells whether the face's normal is the contact's own.
TEST(ContactDetector, RoundOffDoesNotTurnFramesAtTheEdgeOfABox) {
  const TwoByTwo scene = makeScene();
  std::vector<Instrument> instruments;
  instruments.push_back(makeInstrument("box", {box({0.01, 0.01, 0.01}, Vector3::Zero())}));
  const ContactDetector detector(instruments, shareSurfaces(scene.surfaces, scene.positions));
  const std::vector<std::vector<Pose>> still = {{Pose::Identity(), Pose::Identity()}};
  const std::vector<std::vector<Pose>> rolled = {{Pose::Identity(), Pose(Eigen::AngleAxisd(1e-3, Vector3::UnitX()))}};
  const auto turned = [&](double beyond_y, double beyond_z) {
    Contact contact;
    contact.key = {0, 0, 0, 0, {0, 1, -1}};
    contact.p_WC = {0.0, 0.005 + beyond_y, -0.005 - beyond_z};
    contact.R_WC = contactFrame(Vector3(0.0, 0.02, -1.0).normalized());
    contact.gap_m = -1e-9;
    detector.turnWithSlide(still, rolled, {1e-4, 0.0, 0.0}, contact);
    return contact;
  };
  const Contact at_edge = turned(0.0, 0.0);
  for (const double y : {-2e-9, -1e-15, 1e-15, 2e-9}) {
    for (const double z : {-2e-9, -1e-15, 1e-15, 2e-9}) {
      const Contact beside = turned(y, z);
      EXPECT_LT((beside.R_WC - at_edge.R_WC).norm(), 1e-7) << y << ' ' << z;  // of 1e-3
      EXPECT_NEAR(beside.gap_m, at_edge.gap_m, 1e-12) << y << ' ' << z;
    }
  }
  const Vector3 with_face = turned(-2e-4, 0.0).R_WC.col(0) - at_edge.R_WC.col(0);
  EXPECT_NEAR(with_face.norm(), 1e-3, 1e-5) << "a face farther from its edge than the way turns with the tool";
}

/// Tissue edges that cross a rim have their deepest point where side and cap are equally deep.
TEST(ContactDetector, RoundOffDoesNotTurnFramesAtTheRimOfACylinder) {
  const TwoByTwo scene = makeScene();
  std::vector<Instrument> instruments;
  instruments.push_back(makeInstrument("rod", {{CylinderGeometry{0.003, 0.02}, Pose::Identity()}}));
  const ContactDetector detector(instruments, shareSurfaces(scene.surfaces, scene.positions));
  const std::vector<std::vector<Pose>> still = {{Pose::Identity(), Pose::Identity()}};
  const auto turned = [&](double beyond, double way, double depth = 1e-6) {
    Contact contact;
    contact.key = {0, 0, 0, 0, {0, -1, -1}};
    contact.p_WC = {0.0, -0.003 + depth, 0.01 - depth + beyond};
    contact.R_WC = contactFrame(Vector3(0.0, -1.0, 0.02).normalized());
    contact.gap_m = -1e-6;
    detector.turnWithSlide(still, still, {way, 0.0, 0.0}, contact);
    return contact;
  };
  for (const double depth : {1e-6, 0.0, -1e-15}) {
    const Contact at_rim = turned(0.0, 2e-4, depth);
    for (const double beyond : {-1e-12, -1e-15, 1e-15, 1e-12}) {
      const Contact beside = turned(beyond, 2e-4, depth);
      EXPECT_LT((beside.R_WC - at_rim.R_WC).norm(), 1e-8) << beyond;
      EXPECT_NEAR(beside.gap_m, at_rim.gap_m, 1e-12) << beyond;
    }
  }
  // A side that is the nearest face by more than the way turns by all of it: way / radius.
  EXPECT_NEAR(turned(-3e-4, 2e-4).R_WC(0, 0), 2e-4 / 0.003, 1e-3);
}

TEST(ContactDetector, RepeatsToTheLastBitWhateverItSawBefore) {
  TwoByTwo scene = makeScene();
  ContactDetector detector(scene.instruments, shareSurfaces(scene.surfaces, scene.positions));
  Random random(41);
  std::vector<Contact> contacts;
  std::vector<Contact> again;
  std::vector<Contact> fresh;
  std::size_t total = 0;
  for (int i = 0; i < 20; ++i) {
    for (NodalVectors& nodes : scene.positions) {
      for (Eigen::Index n = 0; n < nodes.cols(); ++n) nodes.col(n) += random.vector(5e-4);
    }
    scene.X_WL[0][1] = at({0.0, 0.0, 0.0245}) * random.pose(0.001);
    detector.detect(scene.positions, scene.X_WL, 1e-3, contacts);
    detector.detect(scene.positions, scene.X_WL, 1e-3, again);
    EXPECT_TRUE(sameBits(contacts, again));
    // Built for these very positions, the tree has another structure; the contacts must not know.
    ContactDetector(scene.instruments, shareSurfaces(scene.surfaces, scene.positions))
        .detect(scene.positions, scene.X_WL, 1e-3, fresh);
    EXPECT_TRUE(sameBits(contacts, fresh));
    total += contacts.size();
  }
  EXPECT_GT(total, 200u);
}

TEST(ContactDetector, RefusesWhatDoesNotFit) {
  TwoByTwo scene = makeScene();
  const auto build = [&] { return ContactDetector(scene.instruments, shareSurfaces(scene.surfaces, scene.positions)); };
  {
    ContactDetector detector = build();
    std::vector<Contact> contacts;
    for (const double margin :
         {-1e-3, std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
      EXPECT_THROW(detector.detect(scene.positions, scene.X_WL, margin, contacts), std::invalid_argument);
    }
    EXPECT_THROW(detector.detect(scene.positions, scene.X_WL, std::vector<double>{1e-3}, contacts),
                 std::invalid_argument);
    EXPECT_THROW(detector.detect(scene.positions, scene.X_WL, std::vector<double>{1e-3, -1e-3}, contacts),
                 std::invalid_argument);
    EXPECT_THROW(detector.detect({scene.positions[0]}, scene.X_WL, 1e-3, contacts), std::invalid_argument);
    EXPECT_THROW(detector.detect(scene.positions, {scene.X_WL[0]}, 1e-3, contacts), std::invalid_argument);
    EXPECT_THROW(detector.detect(scene.positions, {{Pose::Identity()}, {Pose::Identity()}}, 1e-3, contacts),
                 std::invalid_argument);
    EXPECT_THROW(detector.detect({scene.positions[0], NodalVectors::Zero(3, 2)}, scene.X_WL, 1e-3, contacts),
                 std::invalid_argument);
  }
  scene.surfaces[1].triangles[3] = {0, 1, 100000};
  EXPECT_THROW(build(), std::invalid_argument);
  scene.surfaces[1].triangles[3] = {0, -1, 2};
  EXPECT_THROW(build(), std::invalid_argument);
  scene.surfaces[1].triangles[3] = {0, 1, 1};
  EXPECT_THROW(build(), std::invalid_argument);
  scene = makeScene();
  scene.surfaces[0].fixed.pop_back();
  EXPECT_THROW(build(), std::invalid_argument);
  scene = makeScene();
  scene.positions.pop_back();
  EXPECT_THROW(build(), std::invalid_argument);
}

TEST(ContactDetector, NoTissueNoInstrumentNoContact) {
  std::vector<Contact> contacts(3);
  ContactDetector nothing({}, shareSurfaces({}, {}));
  nothing.detect({}, {}, 1e-3, contacts);
  EXPECT_TRUE(contacts.empty());
  TwoByTwo scene = makeScene();
  for (auto& poses : scene.X_WL) poses[1] = at({0.0, 0.0, 1.0});
  ContactDetector far(scene.instruments, shareSurfaces(scene.surfaces, scene.positions));
  far.detect(scene.positions, scene.X_WL, 1e-3, contacts);
  EXPECT_TRUE(contacts.empty());
}

TEST(SmallestHalfExtent, OfEveryShape) {
  CollisionShape shape;
  shape.geometry = SphereGeometry{0.005};
  EXPECT_DOUBLE_EQ(smallestHalfExtent(shape), 0.005);
  shape.geometry = BoxGeometry{{0.02, 0.006, 0.01}};
  EXPECT_DOUBLE_EQ(smallestHalfExtent(shape), 0.003);
  shape.geometry = CylinderGeometry{0.004, 0.006};
  EXPECT_DOUBLE_EQ(smallestHalfExtent(shape), 0.003);
  shape.geometry = CylinderGeometry{0.004, 0.1};
  EXPECT_DOUBLE_EQ(smallestHalfExtent(shape), 0.004);
  shape.geometry = MeshGeometry{"jaw.stl", Vector3::Ones()};
  EXPECT_THROW(smallestHalfExtent(shape), std::invalid_argument);
  shape.mesh = std::make_shared<TriangleMesh>(boxMesh({0.01, 0.002, 0.003}, 2));
  EXPECT_DOUBLE_EQ(smallestHalfExtent(shape), 0.002);
}

}  // namespace contact_detector_test
}  // namespace tissue_contact::contact_test
