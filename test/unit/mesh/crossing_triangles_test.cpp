/// What a surface is refused for before it is filled: triangles that cross, and none that do not; borders. Also of surfaces made to take long.
#include "mesh/fill/crossing_triangles.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <cmath>
#include <vector>

#include "mesh/fill/closed_surface.h"
#include "support/refusal.h"
#include "tissue_contact/mesh/triangle_mesh.h"

namespace tissue_contact {
namespace crossing_triangles_test {

// The strips of a tube are flat along it: triangles in one plane whose determinant is round-off. 26 pairs of these were told to cross.
TEST(CrossingTriangles, OfATubeThereAreNone) {
  constexpr int kAround = 36;
  constexpr int kAlong = 20;
  const Matrix3 R = Eigen::AngleAxisd(0.7, Vector3(1.0, 2.0, -1.0).normalized()).toRotationMatrix();
  TriangleMesh tube;
  tube.vertices.resize(3, kAround * (kAlong + 1));
  for (int i = 0; i < tube.vertices.cols(); ++i) {
    const double angle = 2.0 * M_PI * (i % kAround) / kAround;
    tube.vertices.col(i) = R * Vector3(0.01 * std::cos(angle), 0.01 * std::sin(angle), 0.0037 * (i / kAround));
  }
  for (int k = 0; k < kAlong; ++k) {
    for (int i = 0; i < kAround; ++i) {
      const int next = (i + 1) % kAround;
      const int a = k * kAround + i, b = k * kAround + next, c = a + kAround, d = b + kAround;
      tube.triangles.push_back({a, b, d});
      tube.triangles.push_back({a, d, c});
    }
  }
  EXPECT_EQ(findCrossings(tube).count, 0u);
}

// Of 5000 tetrahedra around one point they took 57 s to count, and days of the largest file that is read.
TEST(CrossingTriangles, AreNotCountedBeyondABound) {
  std::vector<Vector3> points;
  std::vector<Triangle> triangles;
  for (int i = 0; i < 300; ++i) {  // 130 000 pairs
    const double size = 1.0 + 1e-3 * i;
    const int first = static_cast<int>(points.size());
    for (const Vector3& p : {Vector3(1, 1, 1), Vector3(1, -1, -1), Vector3(-1, 1, -1), Vector3(-1, -1, 1)}) {
      points.emplace_back(size * p + 0.2 * Vector3(std::cos(i), std::sin(i), std::sin(3.0 * i)));
    }
    for (const Triangle& t : {Triangle{0, 1, 2}, Triangle{0, 3, 1}, Triangle{0, 2, 3}, Triangle{1, 3, 2}}) {
      triangles.push_back({first + t[0], first + t[1], first + t[2]});
    }
  }
  TriangleMesh mesh{NodalVectors(3, static_cast<Eigen::Index>(points.size())), triangles};
  for (std::size_t i = 0; i < points.size(); ++i) mesh.vertices.col(static_cast<Eigen::Index>(i)) = points[i];
  const Crossings crossings = findCrossings(mesh);
  EXPECT_EQ(crossings.count, Crossings::kMost + 1);
  EXPECT_NE(crossingText(crossings).find("; more than 10000 pairs of triangles cross"), std::string::npos);
}

// Each vertex of a border was looked for among all before it: 3.9 s of this ribbon, now 0.5, and 31 s of 600 000 triangles.
TEST(ClosedSurface, ALongBorderIsFoundAtOnce) {
  constexpr int kSteps = 100000;
  TriangleMesh ribbon;
  ribbon.vertices.resize(3, 2 * kSteps + 2);
  for (int i = 0; i <= kSteps; ++i) {
    ribbon.vertices.col(2 * i) = Vector3(1e-5 * i, 0.0, 0.0);
    ribbon.vertices.col(2 * i + 1) = Vector3(1e-5 * i, 0.01, 0.0);
    if (i == kSteps) break;
    ribbon.triangles.push_back({2 * i, 2 * i + 2, 2 * i + 1});
    ribbon.triangles.push_back({2 * i + 1, 2 * i + 2, 2 * i + 3});
  }
  expectContains(refusal([&] { closeSurface(ribbon, 0.001, "ribbon"); }), {"ribbon: it is open: 1 hole, the widest"});
}

}  // namespace crossing_triangles_test
}  // namespace tissue_contact
