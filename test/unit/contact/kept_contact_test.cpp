// Which way a tool presses a point of the tissue that it keeps: beside an edge of the tool not by whichever face is nearer.
#include <gtest/gtest.h>

#include "contact/contact_direction.h"
#include "contact_test_utilities.h"

namespace tissue_contact::contact_test {
namespace kept_contact_test {

constexpr double kSmall = 1e-9;  // m

/// At the middle of a triangle beside the edge through x = .006, z = .002. It looks along -outward, and is so small that nothing bends its gap.
SignedDistance keptAt(const ShapeDistance& shape, double beyond_side, double beyond_cap, const Vector3& outward,
                      double y = 0.0) {
  const Vector3 middle(0.006 + beyond_side, y, 0.002 + beyond_cap), n = outward.normalized();
  const Vector3 s = Vector3::UnitY(), t = n.cross(s);
  TrianglePoints points;
  for (int i = 0; i < 3; ++i) {
    const double angle = 2.0 * M_PI * i / 3.0;
    points.corners[i] = middle + kSmall * (std::cos(angle) * s + std::sin(angle) * t);
  }
  points.normal = -n;
  return keptContact(shape, points, Vector3::Constant(1.0 / 3.0));
}

// Sides and caps are a right angle apart, and round-off tells which is nearer.
TEST(KeptContact, OnWhicheverSideOfAnEdgeAPointLiesItIsPressedSquareToTheTissue) {
  for (const EdgedTool& tool : edgedTools()) {
    for (const Vector3& outward : {Vector3(1.0, 0.0, 0.2), Vector3(1.0, 0.0, 1.0), Vector3(0.1, 0.0, 1.0)}) {
      for (const double side : {-1e-7, -1e-9, 0.0, 1e-9, 1e-7}) {
        for (const double cap : {-1e-7, -1e-9, 0.0, 1e-9, 1e-7}) {
          const SignedDistance kept = keptAt(*tool.shape, side, cap, outward);
          EXPECT_LT((kept.normal - outward.normalized()).norm(), 1e-9) << tool.name << ' ' << side << ' ' << cap;
          EXPECT_NEAR(kept.distance, 0.0, 1.5e-7) << tool.name;
        }
      }
    }
  }
}

/// At the middle of an edge along `along` between two triangles whose normals' mean looks along -outward.
SignedDistance keptOnEdge(const ShapeDistance& shape, const Vector3& beyond, const Vector3& along,
                          const Vector3& outward) {
  const Vector3 middle = Vector3(0.006, 0.0, 0.002) + beyond, e = along.normalized();
  TrianglePoints points;
  points.corners = {middle - 1e-3 * e, middle + 1e-3 * e, middle + 1e-3 * e.cross(outward).normalized()};
  points.normal = -outward.normalized();
  return keptContact(shape, points, Vector3(0.5, 0.5, 0.0));
}

// Where an edge of the tissue runs along the tool's, every face's normal is square to it, and round-off would choose.
TEST(KeptContact, AnEdgeAlongTheToolsIsPressedAsTheSurfaceBesideItLies) {
  const auto box = makeBoxDistance({0.006, 0.004, 0.002});
  for (const Vector3& along : {Vector3(0.0, 1.0, 0.0), Vector3(1e-4, 1.0, 1e-3), Vector3(1e-4, 1.0, -1e-3)}) {
    for (const Vector3& outward : {Vector3(0.01, 0.0, 1.0), Vector3(1.0, 0.0, 0.01), Vector3(1.0, 0.0, 1.0)}) {
      const SignedDistance kept = keptOnEdge(*box, Vector3(1e-7, 0.0, -1e-7), along, outward);
      EXPECT_LT((kept.normal - outward.normalized()).norm(), 0.01) << along.transpose() << ", " << outward.transpose();
    }
  }
}

// Three faces meet there.
TEST(KeptContact, AtACornerOfABoxItIsPressedSquareToTheTissueToo) {
  const auto box = makeBoxDistance({0.006, 0.004, 0.002});
  const Vector3 outward(1.0, 2.0, 1.0);
  const SignedDistance kept = keptAt(*box, -1e-8, 1e-8, outward, 0.004 - 2e-8);
  EXPECT_LT((kept.normal - outward.normalized()).norm(), 1e-9);
}

// Pushed out along a normal between two faces by the gap, a point has left both.
TEST(KeptContact, TheGapIsTheWayOut) {
  for (const EdgedTool& tool : edgedTools()) {
    const Vector3 p(0.006 - 1e-6, 0.0, 0.002 - 1e-6);
    const SignedDistance kept = keptAt(*tool.shape, -1e-6, -1e-6, Vector3(1.0, 0.0, 1.0));
    EXPECT_NEAR(kept.distance, -std::sqrt(2.0) * 1e-6, 1e-12) << tool.name;
    EXPECT_NEAR(tool.shape->at(p - kept.distance * kept.normal).distance, 0.0, 1e-12) << tool.name;
  }
}

// Tissue that faces neither side nor cap: the nearer in direction of both, and always the same.
TEST(KeptContact, TissueThatAnEdgeDoesNotFaceIsPressedByTheFaceNearestToItsNormal) {
  for (const EdgedTool& tool : edgedTools()) {
    for (const double side : {-1e-7, 1e-7}) {
      const SignedDistance kept = keptAt(*tool.shape, side, 0.0, Vector3(1.0, 0.0, -0.3));
      EXPECT_LT((kept.normal - Vector3::UnitX()).norm(), 1e-9) << tool.name << ' ' << side;
    }
  }
}

TEST(KeptContact, AwayFromEdgesItIsTheShapesOwn) {
  for (const EdgedTool& tool : edgedTools()) {
    for (const auto& [side, cap] : {std::pair(-1e-6, -1e-3), std::pair(-1e-3, 1e-6), std::pair(3e-5, 4e-5)}) {
      const SignedDistance own = tool.shape->at(Vector3(0.006 + side, 0.0, 0.002 + cap));
      const SignedDistance kept = keptAt(*tool.shape, side, cap, Vector3(1.0, 0.0, 1.0));
      EXPECT_NEAR(kept.distance, own.distance, 2.0 * kSmall) << tool.name;
      EXPECT_LT((kept.normal - own.normal).norm(), 1e-12) << tool.name;
    }
  }
}

// In the middle of a thin plate both faces are near; their mean has no direction.
TEST(KeptContact, InTheMiddleOfAPlateNothingIsMadeUp) {
  const auto plate = makeBoxDistance({0.006, 0.004, 0.002});
  TrianglePoints points;
  points.corners = {Vector3(0.0, 0.0, kSmall), Vector3(0.0, kSmall, -kSmall), Vector3(0.0, -kSmall, kSmall)};
  points.normal = Vector3::UnitX();
  const SignedDistance kept = keptContact(*plate, points, Vector3::Constant(1.0 / 3.0));
  EXPECT_EQ(kept.normal, Vector3::UnitZ());
  EXPECT_NEAR(kept.distance, -0.002, 2.0 * kSmall);
}

}  // namespace kept_contact_test
}  // namespace tissue_contact::contact_test
