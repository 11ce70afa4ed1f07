// A sharp tip under a valley of the surface, where it projects beside every triangle, still touches.
#include <gtest/gtest.h>

#include "contact_test_utilities.h"

namespace tissue_contact::contact_test {
namespace corner_in_fold_test {

/// Pyramid with its point down at the origin, four sides, half angle of 14 degrees: its flanks alone give no direction
/// that pushes down. Only its corner and, as far as vertices of the tissue ask, its flanks.
class Needle : public ShapeDistance {
 public:
  double size() const override { return 0.01; }
  Vector3 halfExtents(const Matrix3& R_WS) const override { return R_WS.cwiseAbs() * Vector3(0.005, 0.005, 0.01); }
  Vector3 boxCentre() const override { return {0.0, 0.0, 0.01}; }
  SignedDistance at(const Vector3& p_S) const override {
    SignedDistance highest{p_S.z() - 0.02, Vector3::UnitZ()};
    for (const Vector3& side : {Vector3(4, 4, -1), Vector3(-4, 4, -1), Vector3(4, -4, -1), Vector3(-4, -4, -1)}) {
      const double distance = side.normalized().dot(p_S);
      if (distance > highest.distance) highest = {distance, side.normalized()};
    }
    return highest;
  }
  bool closest(const TrianglePoints&, double, ClosestPoint&) const override { return false; }
  void foremostCorners(const Vector3& forward, const Eigen::AlignedBox3d& box,
                       std::vector<ShapeCorner>& corners) const override {
    corners.clear();
    if (forward.z() < -0.5 && box.contains(Vector3::Zero())) corners.push_back({0, Vector3::Zero()});
  }
};

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
  const Needle shape;
  for (const double depth : {1e-9, 1e-6, 1e-4, 1e-3}) {
    for (const double x : {0.0, 0.003}) {
      const auto contacts = findContacts(shape, at({x, 0.0, -depth}), fold(0.3), 1e-3);
      const ShapeContact* const contact = cornerContact(contacts);
      ASSERT_NE(contact, nullptr) << depth;
      EXPECT_EQ(contact->feature, (SurfaceFeature{0, 1, -1}));
      EXPECT_LE((contact->normal_W + Vector3::UnitZ()).norm(), 1e-12);
      EXPECT_NEAR(contact->gap, -depth, 1e-12);
    }
  }
}

TEST(CornerInFold, TipAboveAValleyTouchesBothSides) {
  const Needle shape;
  int corners = 0;
  for (const ShapeContact& one : findContacts(shape, at({0.0, 0.0, 1e-5}), fold(0.3), 1e-3)) corners += one.corner >= 0;
  EXPECT_EQ(corners, 2);
}

// Below the planes of both triangles, but off to one side: the nearest point lies inside a triangle.
TEST(CornerInFold, TipBesideTheFoldIsLeftToItsTriangle) {
  const Needle shape;
  for (const ShapeContact& one : findContacts(shape, at({0.0, 0.003, -1e-3}), fold(0.3), 1e-3)) {
    if (one.corner < 0) continue;
    EXPECT_EQ(one.feature, (SurfaceFeature{0, 1, 2}));
  }
}

// Next to a block and below its upper face there is nothing to push down.
TEST(CornerInFold, TipNextToARimIsNotInside) {
  const Needle shape;
  const Surface block = boxSurface({0.1, 0.1, 0.03}, {10, 10, 3});
  const auto contacts = findContacts(shape, at({-0.006, 0.052, 0.02}), block, 1e-3);
  EXPECT_EQ(cornerContact(contacts), nullptr);
}

}  // namespace corner_in_fold_test
}  // namespace tissue_contact::contact_test
