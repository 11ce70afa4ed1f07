// The direction of a vertex's contact: a smooth shape's mean normal over the surface that the vertex stands for.
#include "contact/nodal_normal.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "contact_test_utilities.h"

namespace tissue_contact::contact_test {
namespace nodal_normal_test {

constexpr double kRadius = 0.005;
constexpr int kSectors = 6;
const Vector3 kDown = -Vector3::UnitZ();

/// Corners around the lowest point of a ball that lies on the plane z = -kRadius; those with x < 0 are `stretch` times
/// as far away.
std::array<Vector3, 3> sector(int k, double edge, double stretch) {
  const auto at = [&](int corner) {
    const double angle = 2.0 * M_PI * (corner + 0.5) / kSectors;
    Vector3 p = edge * Vector3(std::cos(angle), std::sin(angle), 0.0);
    if (p.x() < 0.0) p.x() *= stretch;
    return Vector3(p + kRadius * kDown);
  };
  return {kRadius * kDown, at(k), at(k + 1)};
}

Vector3 meanOf(const ShapeDistance& shape, double edge, double stretch) {
  NodalNormal normal(shape, kRadius * kDown, kDown, false);
  for (int k = 0; k < kSectors; ++k) normal.add(sector(k, edge, stretch), 0);
  return normal.mean();
}

/// Normals over the third of a triangle next to its first corner, by points in the middle of many small parts; times
/// the area.
Vector3 integralOverThird(const ShapeDistance& shape, const std::array<Vector3, 3>& corners) {
  constexpr int kParts = 300;
  const Vector3 a = corners[1] - corners[0], b = corners[2] - corners[0];
  Vector3 sum = Vector3::Zero();
  for (int i = 0; i < kParts; ++i) {
    for (int j = 0; i + j < kParts; ++j) {
      const double s = (i + 1.0 / 3.0) / kParts, t = (j + 1.0 / 3.0) / kParts;
      if (1.0 - s - t < std::max(s, t)) continue;  // nearer to another corner, in barycentric weights
      sum += shape.at(corners[0] + s * a + t * b).normal;
    }
  }
  return a.cross(b).norm() * sum;
}

TEST(NodalNormal, OfAnEvenPatchIsTheVertexsOwn) {
  EXPECT_LE((meanOf(*makeSphereDistance(kRadius), 0.001, 1.0) - kDown).norm(), 1e-12);
}

TEST(NodalNormal, LeansToWhereTrianglesAreLarger) {
  const auto ball = makeSphereDistance(kRadius);
  for (const double stretch : {1.2, 1.7}) {
    Vector3 expected = Vector3::Zero();
    for (int k = 0; k < kSectors; ++k) expected += integralOverThird(*ball, sector(k, 0.001, stretch));
    expected.normalize();
    const Vector3 found = meanOf(*ball, 0.001, stretch);
    EXPECT_LT(expected.x(), -0.005) << stretch;
    // One point per triangle: of second order in the edge over the radius, .2 of it here.
    EXPECT_LE((found - expected).norm(), 0.05 * std::abs(expected.x())) << stretch;
    EXPECT_NEAR(found.norm(), 1.0, 1e-12);
  }
}

TEST(NodalNormal, OfASampledBallIsThatOfTheBall) {
  const auto mesh = makeMeshDistance(sphereMesh(kRadius, 4));
  const Vector3 own = mesh->at(kRadius * kDown).normal;
  NodalNormal normal(*mesh, kRadius * kDown, own, false);
  for (int k = 0; k < kSectors; ++k) normal.add(sector(k, 0.001, 1.7), 0);
  const double expected = meanOf(*makeSphereDistance(kRadius), 0.001, 1.7).x();
  EXPECT_NEAR((normal.mean() - own).x(), expected, 0.2 * std::abs(expected));  // its triangles turn by .07 each
}

// At the edge of a block half of the triangles around a vertex are of the wall below, which bears nothing.
TEST(NodalNormal, OnlyWhatFacesTheShapeCounts) {
  const Surface block = boxSurface({0.02, 0.02, 0.01}, {10, 10, 5});
  const double radius = 0.005;
  const Vector3 vertex(0.0, 0.01, 0.01);
  const Vector3 centre = vertex + Vector3(0.0004, 0.0, radius - 1e-5);
  const auto ball = makeSphereDistance(radius);
  const auto contacts = findContacts(*ball, at(centre), block, 1e-4);
  const auto found = std::find_if(contacts.begin(), contacts.end(), [&](const ShapeContact& c) {
    return c.feature[1] < 0 && (pointOf(c, block.nodes) - vertex).norm() < 1e-12;
  });
  ASSERT_NE(found, contacts.end());
  NodalNormal above(*ball, vertex - centre, (vertex - centre).normalized(), false);
  int walls = 0;
  for (const Triangle& triangle : block.triangles) {
    std::array<Vector3, 3> corners;
    std::size_t corner = 3;
    for (std::size_t i = 0; i < 3; ++i) {
      corners[i] = block.nodes.col(triangle[i]) - centre;
      if ((corners[i] + centre - vertex).norm() < 1e-12) corner = i;
    }
    if (corner == 3) continue;
    const bool is_above = corners[0].z() == corners[1].z() && corners[1].z() == corners[2].z();
    if (is_above) above.add(corners, corner);
    walls += !is_above;
  }
  ASSERT_GT(walls, 1);
  EXPECT_LT((found->normal_W - above.mean()).norm(), 1e-12);
  EXPECT_GT(found->lean_W.x(), 0.01) << "all that it stands for lies inwards";
}

TEST(NodalNormal, OfATipThatPokesIntoTrianglesIsTheVertexsOwn) {
  // Edges of two radii: at the centroid of a third of a triangle the ball has turned by more than half a radian.
  EXPECT_EQ(meanOf(*makeSphereDistance(kRadius), 0.01, 1.7), kDown);
}

TEST(NodalNormal, ABoxsSideTurnsNothing) {
  const auto box = makeBoxDistance({0.01, 0.01, kRadius});
  EXPECT_EQ(meanOf(*box, 0.001, 1.7), kDown);
  // Beyond its edge the normal is another's, or, some way off, turns on to it.
  for (const double off : {0.0, 0.0004}) {
    const Vector3 vertex(0.0097, 0.0, -kRadius - off);
    NodalNormal normal(*box, vertex, kDown, false);
    normal.add({vertex, vertex + Vector3(0.002, 0.0, 0.0), vertex + Vector3(0.0, 0.002, 0.0)}, 0);
    EXPECT_EQ(normal.mean(), kDown) << off;
  }
}

TEST(NodalNormal, ACylindersSideCountsAsABalls) {
  const auto cylinder = makeCylinderDistance(kRadius, 0.02);
  const auto turned = [](const Vector3& p) { return Vector3(p.z(), p.y(), p.x()); };  // its axis is z
  NodalNormal normal(*cylinder, turned(kRadius * kDown), turned(kDown), false);
  const auto ball = makeSphereDistance(kRadius);
  NodalNormal of_ball(*ball, kRadius * kDown, kDown, false);
  for (int k = 0; k < kSectors; ++k) {
    const std::array<Vector3, 3> corners = sector(k, 0.001, 1.7);
    std::array<Vector3, 3> along;  // stretched across the cylinder
    for (std::size_t i = 0; i < 3; ++i) along[i] = Vector3(corners[i].z(), corners[i].x(), corners[i].y());
    normal.add(along, 0);
    of_ball.add(corners, 0);
  }
  EXPECT_NEAR(normal.mean().y(), of_ball.mean().x(), 0.01 * std::abs(of_ball.mean().x()));
}

TEST(NodalNormal, ChangesWithoutAJumpFromSmoothToSharp) {
  const auto ball = makeSphereDistance(kRadius);
  Vector3 before = meanOf(*ball, 0.002, 1.7);
  for (int k = 1; k <= 200; ++k) {
    const Vector3 now = meanOf(*ball, 0.002 + k * 4e-5, 1.7);
    EXPECT_LE((now - before).norm(), 0.004) << k;
    before = now;
  }
}

}  // namespace nodal_normal_test
}  // namespace tissue_contact::contact_test
