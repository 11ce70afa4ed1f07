/// Gaps of triangles against shapes that are smooth or sharp compared with them.
#include "contact/conforming_gap.h"

#include <gtest/gtest.h>

#include <cmath>

namespace tissue_contact {
namespace conforming_gap_test {

/// A right triangle with legs `edge` in the plane z = 0; a sphere of radius R above the point with weights w, its lowest
/// point at height `gap`.
ConformingGap overSphere(double edge, double radius, const Vector3& weights, double gap) {
  const std::array<Vector3, 3> corners = {Vector3(0, 0, 0), Vector3(edge, 0, 0), Vector3(0, edge, 0)};
  Vector3 p = Vector3::Zero();
  for (int i = 0; i < 3; ++i) p += weights[i] * corners[i];
  const Vector3 centre = p + Vector3(0, 0, radius + gap);
  std::array<double, 3> distances;
  for (int i = 0; i < 3; ++i) distances[i] = (corners[i] - centre).norm() - radius;
  return conformingGap(corners, distances, weights, gap);
}

const Vector3 kMiddle = Vector3::Constant(1.0 / 3.0);

// l^2 of the middle: edge^2 (2/9 + 5/9 + 5/9) / 3 = 4/9 edge^2; sagitta l^2 / (2 R) to first order in (l / R)^2.
TEST(ConformingGap, LargeSphereLeavesTheSagittaOut) {
  const ConformingGap result = overSphere(0.001, 0.04, kMiddle, -1e-4);
  EXPECT_TRUE(result.fully);
  EXPECT_NEAR(result.gap + 1e-4, 4.0 / 9.0 * 1e-6 / 0.08, 1e-3 * 4.0 / 9.0 * 1e-6 / 0.08 + 1e-8);
}

TEST(ConformingGap, SmallSpherePokesIntoTheMiddle) {
  const ConformingGap result = overSphere(0.01, 0.005, kMiddle, -1e-4);
  EXPECT_FALSE(result.fully);
  EXPECT_DOUBLE_EQ(result.gap, -1e-4);
}

TEST(ConformingGap, VertexIsItsOwnGap) {
  const ConformingGap result = overSphere(0.001, 0.04, Vector3::UnitY(), -1e-4);
  EXPECT_TRUE(result.fully);
  EXPECT_DOUBLE_EQ(result.gap, -1e-4);
}

// From smooth to sharp the gap changes without a jump: over radii 1 % apart it changes by no more than a few per cent of
// the sagitta.
TEST(ConformingGap, ChangesWithoutAJumpFromSmoothToSharp) {
  double before = overSphere(0.001, 0.01, kMiddle, 0.0).gap;
  bool was_full = true;
  for (int k = 0; k <= 298; ++k) {  // 10 mm to .5 mm
    const double radius = 0.01 * std::pow(0.99, k);
    const ConformingGap result = overSphere(0.001, radius, kMiddle, 0.0);
    const double sagitta = 4.0 / 9.0 * 1e-6 / (2.0 * radius);
    EXPECT_NEAR(result.gap, before, 0.08 * sagitta) << radius;
    EXPECT_TRUE(was_full || !result.fully) << "once sharp, never smooth again";
    was_full = result.fully;
    before = result.gap;
  }
  EXPECT_EQ(before, 0.0);
}

}  // namespace conforming_gap_test
}  // namespace tissue_contact
