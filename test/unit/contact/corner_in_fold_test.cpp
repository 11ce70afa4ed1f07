// A sharp tip under a valley of the surface, where it projects beside every triangle, still touches.
#include <gtest/gtest.h>

#include "contact_test_utilities.h"

namespace tissue_contact {
namespace {

using contact_test::at;
using contact_test::findContacts;
using contact_test::Surface;

/// Point down at the origin, four sides, half angle of 14 degrees: its flanks alone give no direction that pushes down.
TriangleMesh needle() {
  TriangleMesh mesh;
  mesh.vertices.resize(3, 5);
  mesh.vertices.transpose() << 0, 0, 0, 5, 0, 20, 0, 5, 20, -5, 0, 20, 0, -5, 20;
  mesh.vertices *= 1e-3;
  mesh.triangles = {{0, 2, 1}, {0, 3, 2}, {0, 4, 3}, {0, 1, 4}, {1, 2, 3}, {1, 3, 4}};
  return mesh;
}

/// Two triangles that meet along x and rise by 0.3 to both sides (or fall: a ridge).
Surface fold(double rise) {
  Surface surface;
  surface.nodes.resize(3, 4);
  surface.nodes.transpose() << -1, 0, 0, 1, 0, 0, 0, 1, rise, 0, -1, rise;
  surface.nodes *= 0.01;
  surface.triangles = {{0, 1, 2}, {1, 0, 3}};
  return surface;
}

const ShapeContact* cornerContact(const std::vector<ShapeContact>& contacts) {
  for (const ShapeContact& one : contacts) {
    if (one.corner >= 0) return &one;
  }
  return nullptr;
}

// What was lost before: a tip 1 nm to 1 mm below the bottom of the valley, on which it rested just above.
TEST(CornerInFold, TipBelowAValleyIsPushedStraightBack) {
  const auto shape = makeMeshDistance(needle());
  for (const double depth : {1e-9, 1e-6, 1e-4, 1e-3}) {
    for (const double x : {0.0, 0.003}) {
      const auto contacts = findContacts(*shape, at({x, 0.0, -depth}), fold(0.3), 1e-3);
      const ShapeContact* const contact = cornerContact(contacts);
      ASSERT_NE(contact, nullptr) << depth;
      EXPECT_EQ(contact->feature, (SurfaceFeature{0, 1, -1}));
      EXPECT_LE((contact->normal_W + Vector3::UnitZ()).norm(), 1e-12);
      EXPECT_NEAR(contact->gap, -depth, 1e-12);
    }
  }
}

TEST(CornerInFold, TipAboveAValleyTouchesBothSides) {
  const auto shape = makeMeshDistance(needle());
  int corners = 0;
  for (const ShapeContact& one : findContacts(*shape, at({0.0, 0.0, 1e-5}), fold(0.3), 1e-3))
    corners += one.corner >= 0;
  EXPECT_EQ(corners, 2);
}

// Below the planes of both triangles, but off to one side: the nearest point lies inside a triangle.
TEST(CornerInFold, TipBesideTheFoldIsLeftToItsTriangle) {
  const auto shape = makeMeshDistance(needle());
  for (const ShapeContact& one : findContacts(*shape, at({0.0, 0.003, -1e-3}), fold(0.3), 1e-3)) {
    if (one.corner < 0) continue;
    EXPECT_EQ(one.feature, (SurfaceFeature{0, 1, 2}));
  }
}

// Next to a block and below its upper face there is nothing to push down.
TEST(CornerInFold, TipNextToARimIsNotInside) {
  const auto shape = makeMeshDistance(needle());
  const Surface block = contact_test::boxSurface({0.1, 0.1, 0.03}, {10, 10, 3});
  const auto contacts = findContacts(*shape, at({-0.006, 0.052, 0.02}), block, 1e-3);
  EXPECT_EQ(cornerContact(contacts), nullptr);
}

}  // namespace
}  // namespace tissue_contact
