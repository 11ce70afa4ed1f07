#include "mesh/surface/outer_surface.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <random>
#include <vector>

#include "mesh/surface/triangle_geometry.h"

namespace tissue_contact {
namespace outer_surface_test {

/// A prism of 24 sides, its side faces as long as it is.
TriangleMesh shaft(double radius_m, double length_m) {
  constexpr int kSides = 24;
  TriangleMesh mesh;
  mesh.vertices.resize(3, 2 * kSides + 2);
  mesh.vertices.col(2 * kSides) = Vector3::Zero();
  mesh.vertices.col(2 * kSides + 1) = Vector3(0.0, 0.0, length_m);
  for (int i = 0; i < kSides; ++i) {
    const double angle = 2.0 * M_PI * i / kSides;
    const int next = (i + 1) % kSides;
    for (const int k : {0, 1}) {
      mesh.vertices.col(2 * i + k) = Vector3(radius_m * std::cos(angle), radius_m * std::sin(angle), k * length_m);
    }
    mesh.triangles.push_back({2 * i, 2 * next, 2 * next + 1});
    mesh.triangles.push_back({2 * i, 2 * next + 1, 2 * i + 1});
    mesh.triangles.push_back({2 * kSides, 2 * next, 2 * i});
    mesh.triangles.push_back({2 * kSides + 1, 2 * i + 1, 2 * next + 1});
  }
  return mesh;
}

// Cut into four alike, again and again, these became 50 000 needles around the axis, and a grid beside them took 20 s.
TEST(OuterSurface, TheLongTrianglesOfAShaftAreCutAcross) {
  constexpr double kFinest = 0.001;
  const TriangleMesh mesh = shaft(0.001, 0.4);
  const TriangleMesh outer = outerSurface(mesh, WindingTree(mesh), kFinest);
  EXPECT_LT(outer.triangles.size(), 15000U);
  double area = 0.0;
  for (const Triangle& t : outer.triangles) {
    area += triangleArea(outer.vertices, t);
    for (int i = 0; i < 3; ++i) {
      EXPECT_LT((outer.vertices.col(t[i]) - outer.vertices.col(t[(i + 1) % 3])).norm(), 16.0 * kFinest);
    }
  }
  double whole = 0.0;
  for (const Triangle& t : mesh.triangles) whole += triangleArea(mesh.vertices, t);
  EXPECT_NEAR(area, whole, 1e-12 * whole) << "nothing of it is inside";
}

/// Bars from everywhere to everywhere in a ball of 100 mm.
TriangleMesh tangle(int bars) {
  std::mt19937 random(3);
  std::normal_distribution<double> normal;
  TriangleMesh mesh;
  mesh.vertices.resize(3, 3 * bars * 2);
  for (int i = 0; i < bars; ++i) {
    const Vector3 from = 0.1 * Vector3(normal(random), normal(random), normal(random)).normalized();
    const Vector3 to = 0.1 * Vector3(normal(random), normal(random), normal(random)).normalized();
    const Vector3 aside = 0.004 * (to - from).unitOrthogonal();
    const Vector3 up = 0.004 * aside.cross(to - from).normalized();
    const int a = 6 * i;
    for (const int end : {0, 1}) {
      const Vector3& p = end == 0 ? from : to;
      mesh.vertices.col(a + 3 * end) = p + aside;
      mesh.vertices.col(a + 3 * end + 1) = p - 0.5 * aside + up;
      mesh.vertices.col(a + 3 * end + 2) = p - 0.5 * aside - up;
    }
    mesh.triangles.push_back({a, a + 2, a + 1});
    mesh.triangles.push_back({a + 3, a + 4, a + 5});
    for (int k = 0; k < 3; ++k) {
      const int next = (k + 1) % 3;
      mesh.triangles.push_back({a + k, a + next, a + 3 + next});
      mesh.triangles.push_back({a + k, a + 3 + next, a + 3 + k});
    }
  }
  return mesh;
}

// Silent before, however long it took.
TEST(OuterSurface, SaysHowFarItIs) {
  const TriangleMesh mesh = tangle(5);
  std::vector<double> shares;
  std::size_t left = 1;
  outerSurface(
      mesh, WindingTree(mesh), 0.004, [&](double share) { shares.push_back(share); }, &left);
  EXPECT_EQ(shares.size(), mesh.triangles.size());
  EXPECT_TRUE(std::is_sorted(shares.begin(), shares.end()));
  EXPECT_EQ(left, 0U);
}

}  // namespace outer_surface_test
}  // namespace tissue_contact
