// Instruments against sheets: both sides, half the thickness, boundaries, and contacts brought up to date.
#include <gtest/gtest.h>

#include <limits>
#include <string>

#include "tissue_pair_test_utilities.h"

namespace tissue_contact {
namespace sheet_contact_test {

using namespace contact_test;

constexpr double kPi = 3.14159265358979323846;
constexpr double kThick = 1e-3;

/// One shape over one sheet.
class Probe {
 public:
  Probe(const ShapeGeometry& geometry, const Surface& sheet, double thickness = kThick)
      : instruments_{makeInstrument("probe", {{geometry, Pose::Identity()}})},
        detector_(instruments_, shareSurfaces({{sheet.triangles, sheet.fixed(), thickness}}, {sheet.nodes})) {}

  std::vector<Contact> contacts(const NodalVectors& nodes, const Pose& X_WS, double margin) {
    std::vector<Contact> result;
    detector_.detect({nodes}, {{Pose::Identity(), X_WS}}, margin, result);
    return result;
  }
  bool measure(const NodalVectors& nodes, const Pose& X_WS, double margin, Contact& contact) const {
    return detector_.measure({nodes}, {{Pose::Identity(), X_WS}}, margin, contact);
  }

 private:
  std::vector<Instrument> instruments_;
  ContactDetector detector_;
};

TEST(SheetContact, SphereOnEitherSide) {
  const Surface sheet = sheetSurface({0.1, 0.1}, 10, 10);
  Probe probe(SphereGeometry{0.005}, sheet);
  for (const double side : {1.0, -1.0}) {
    for (const double gap : {8e-6, 0.0, -1e-4, -2e-3}) {
      const Vector3 centre(0.0533, 0.0482, side * (0.005 + 0.5 * kThick + gap));
      const auto contacts = probe.contacts(sheet.nodes, at(centre), 1e-5);
      ASSERT_FALSE(contacts.empty());
      const Contact& nearest = *std::min_element(contacts.begin(), contacts.end(),
                                                 [](const Contact& a, const Contact& b) { return a.gap_m < b.gap_m; });
      EXPECT_NEAR(nearest.gap_m, gap, 1e-16);
      EXPECT_LT((normalOf(nearest) + side * Vector3::UnitZ()).norm(), 1e-12);
      EXPECT_LT((nearest.p_WC - Vector3(0.0533, 0.0482, 0.0)).norm(), 1e-15);
      for (const Contact& c : contacts) EXPECT_LT(side * normalOf(c).z(), 0.0);
    }
    EXPECT_TRUE(probe.contacts(sheet.nodes, at({0.0533, 0.0482, side * (0.005 + 0.5 * kThick + 2e-5)}), 1e-5).empty());
  }
}

TEST(SheetContact, FlatShapesLieFlushOnEitherSide) {
  const Surface sheet = sheetSurface({0.1, 0.1}, 10, 10);
  const TriangleMesh block = boxMesh({0.017, 0.012, 0.004}, 2);
  const std::pair<std::string, ShapeGeometry> shapes[] = {{"box", BoxGeometry{{0.034, 0.024, 0.008}}},
                                                          {"cylinder", CylinderGeometry{0.015, 0.008}}};
  for (const auto& [name, geometry] : shapes) {
    Probe probe(geometry, sheet);
    for (const double side : {1.0, -1.0}) {
      for (const double gap : {8e-6, 0.0, -1e-4}) {
        const Pose X = at({0.0511, 0.0483, side * (0.004 + 0.5 * kThick + gap)});
        const auto contacts = probe.contacts(sheet.nodes, X, 1e-5);
        EXPECT_GE(contacts.size(), 4u) << name;
        int corners = 0;
        for (const Contact& c : contacts) {
          EXPECT_NEAR(c.gap_m, gap, 1e-12) << name;
          EXPECT_LT((normalOf(c) + side * Vector3::UnitZ()).norm(), 1e-9) << name;
          corners += c.key.corner >= 0;
        }
        EXPECT_EQ(corners, name == "box" ? 4 : 0);
      }
    }
  }
  const auto mesh = makeMeshDistance(block);
  const MovingSurface moving(0, {sheet.triangles, sheet.fixed(), kThick}, sheet.nodes);
  NarrowPhase narrow_phase;
  std::vector<int> all(sheet.triangles.size());
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = static_cast<int>(i);
  for (const double side : {1.0, -1.0}) {
    std::vector<ShapeContact> contacts;
    narrow_phase.findContacts(*mesh, at({0.0511, 0.0483, side * (0.004 + 0.5 * kThick - 1e-4)}), moving, all, 1e-5,
                              contacts);
    EXPECT_GE(contacts.size(), 4u);
    for (const ShapeContact& c : contacts) {
      EXPECT_GT(c.gap, -1e-4 - 1e-8);  // samples are single precision
      EXPECT_LT(side * c.normal_W.z(), 0.0);
    }
  }
}

/// A strip laid half around a cylinder from below and from above: the capstan.
TEST(SheetContact, StripAroundACylinder) {
  const double radius = 0.01;
  const int rows = 16;
  const Surface flat = sheetSurface({kPi * radius, 0.01}, rows, 2);
  for (const double lift : {0.0, 5e-6, -2e-5}) {
    for (const double side : {1.0, -1.0}) {
      Surface strip = flat;
      const double away = radius + 0.5 * kThick + lift;
      for (Eigen::Index i = 0; i < flat.nodes.cols(); ++i) {
        const double angle = flat.nodes(0, i) / radius;
        strip.nodes.col(i) = Vector3(-away * std::cos(angle), flat.nodes(1, i) - 0.005, side * away * std::sin(angle));
      }
      Pose X = Pose::Identity();
      X.rotate(Eigen::AngleAxisd(kPi / 2.0, Vector3::UnitX()));
      Probe probe(CylinderGeometry{radius, 0.03}, strip);
      const auto contacts = probe.contacts(strip.nodes, X, 1e-5);
      std::vector<int> nodes_held(strip.nodes.cols(), 0);
      for (const Contact& c : contacts) {
        const Vector3 radial(c.p_WC.x(), 0.0, c.p_WC.z());
        EXPECT_NEAR(c.gap_m, radial.norm() - radius - 0.5 * kThick, 1e-9);
        EXPECT_LT((normalOf(c) - c.lean_W - radial.normalized()).norm(), 1e-6);
        // What a node of the boundary stands for lies on one side of it; elsewhere it is the same all around.
        const double along = flat.nodes(0, c.key.feature[0]) / flat.nodes.row(0).maxCoeff();
        const bool at_boundary = std::abs(c.p_WC.y()) > 0.004 || along < 1e-9 || along > 1.0 - 1e-9;
        EXPECT_LT(c.lean_W.norm(), at_boundary ? 0.25 : 1e-6);
        EXPECT_LT(c.key.feature[1], 0);  // chords of 0.2 radii bend with the cylinder: their ends carry them
        ++nodes_held[c.key.feature[0]];
      }
      for (const int held : nodes_held) EXPECT_EQ(held, 1);
    }
  }
}

TEST(SheetContact, BoundaryIsPushedInThePlaneOfTheSheet) {
  const Surface sheet = sheetSurface({0.1, 0.1}, 10, 10);
  Probe sphere(SphereGeometry{0.005}, sheet);
  const auto contacts = sphere.contacts(sheet.nodes, at({0.1 + 0.005 + 0.5 * kThick - 1e-5, 0.0533, 0.0}), 1e-6);
  ASSERT_EQ(contacts.size(), 1u);
  EXPECT_GE(contacts[0].key.feature[1], 0);
  EXPECT_EQ(contacts[0].key.feature[2], -1);
  EXPECT_NEAR(contacts[0].gap_m, -1e-5, 1e-16);
  EXPECT_LT((normalOf(contacts[0]) + Vector3::UnitX()).norm(), 1e-12);

  Probe box(BoxGeometry{{0.02, 0.02, 0.02}}, sheet);
  const auto flush = box.contacts(sheet.nodes, at({0.11 + 0.5 * kThick - 1e-5, 0.0533, 0.001}), 1e-6);
  ASSERT_FALSE(flush.empty());
  for (const Contact& c : flush) {
    EXPECT_NEAR(c.gap_m, -1e-5, 1e-12);
    EXPECT_LT((normalOf(c) + Vector3::UnitX()).norm(), 1e-9);
  }
}

/// A sheet just past the middle of a shape is pushed out on that side.
TEST(SheetContact, LeavesOnTheNearerSide) {
  const Surface sheet = sheetSurface({0.1, 0.1}, 50, 50);
  for (const double height : {1e-3, -1e-3}) {
    Probe probe(BoxGeometry{{0.03, 0.03, 0.01}}, sheet);
    int vertices = 0;
    for (const Contact& c : probe.contacts(sheet.nodes, at({0.0511, 0.0483, height}), 1e-5)) {
      const bool well_inside = std::abs(c.p_WC.x() - 0.0511) < 0.01 && std::abs(c.p_WC.y() - 0.0483) < 0.01;
      if (c.key.feature[1] >= 0 || !well_inside) continue;
      ++vertices;
      EXPECT_NEAR(c.gap_m, -0.004 - 0.5 * kThick, 1e-15);
      EXPECT_LT((normalOf(c) + (height > 0.0 ? 1.0 : -1.0) * Vector3::UnitZ()).norm(), 1e-12);
    }
    EXPECT_GE(vertices, 81);
  }
}

TEST(SheetContact, MeasureBringsAContactUpToDateOnBothSides) {
  const Surface sheet = sheetSurface({0.1, 0.1}, 10, 10);
  Probe probe(SphereGeometry{0.005}, sheet);
  for (const double side : {1.0, -1.0}) {
    const auto X = [&](double gap) { return at({0.0533, 0.0482, side * (0.005 + 0.5 * kThick + gap)}); };
    const auto contacts = probe.contacts(sheet.nodes, X(-1e-5), 1e-5);
    ASSERT_FALSE(contacts.empty());
    for (const Contact& found : contacts) {
      Contact same = found;
      ASSERT_TRUE(probe.measure(sheet.nodes, X(-1e-5), 1e-5, same));
      EXPECT_NEAR(same.gap_m, found.gap_m, 1e-15);
      EXPECT_LT((same.R_WC - found.R_WC).norm(), 1e-9);
    }
    Contact lifted = contacts.front();
    ASSERT_TRUE(probe.measure(sheet.nodes, X(4e-6), 1e-5, lifted));
    EXPECT_NEAR(lifted.gap_m, contacts.front().gap_m + 1.4e-5, 1e-9);
    EXPECT_FALSE(probe.measure(sheet.nodes, X(1e-4), 1e-5, lifted));
  }
}

TEST(SheetContact, RefusesABadThickness) {
  const Surface sheet = sheetSurface({0.1, 0.1}, 2, 2);
  for (const double thickness : {-1e-3, std::numeric_limits<double>::quiet_NaN(), HUGE_VAL}) {
    EXPECT_THROW(Probe(SphereGeometry{0.005}, sheet, thickness), std::invalid_argument);
  }
}

}  // namespace sheet_contact_test
}  // namespace tissue_contact
