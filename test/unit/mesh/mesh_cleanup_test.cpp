/// Which side of a surface is its outside.
#include "mesh/reader/mesh_cleanup.h"

#include <gtest/gtest.h>

#include <cmath>
#include <utility>

#include "mesh_fixture.h"

namespace tissue_contact {
namespace mesh_cleanup_test {

/// A ball of radius 1 of 24 rings, from the pole down to `last`, outward.
TriangleMesh ball(double x, int last = 24) {
  constexpr int kRings = 24;
  TriangleMesh mesh;
  mesh.vertices.resize(3, (kRings + 1) * 2 * kRings);
  for (int i = 0; i <= kRings; ++i) {
    for (int j = 0; j < 2 * kRings; ++j) {
      const double t = M_PI * i / kRings;
      const double p = M_PI * j / kRings;
      mesh.vertices.col(i * 2 * kRings + j) =
          Vector3(x + std::sin(t) * std::cos(p), std::sin(t) * std::sin(p), std::cos(t));
    }
  }
  for (int i = 0; i < last; ++i) {
    for (int j = 0; j < 2 * kRings; ++j) {
      const int next = (j + 1) % (2 * kRings);
      const int a = i * 2 * kRings;
      const int c = a + 2 * kRings;
      // At the poles all columns are one place.
      if (i > 0) mesh.triangles.push_back({a + j, i + 1 < kRings ? c + j : c, a + next});
      if (i + 1 < kRings) mesh.triangles.push_back({i > 0 ? a + next : a, c + j, c + next});
    }
  }
  return mesh;
}

void turn(TriangleMesh& mesh) {
  for (Triangle& t : mesh.triangles) std::swap(t[1], t[2]);
}

// Left as it was, such a part hollowed the one it overlaps, and the force of a tool was that of a ball with a bite out of it.
TEST(OrientOutward, PartsWithAPinholeAreTurned) {
  const double volume = enclosedVolume(ball(0.0));
  for (const bool is_reversed : {false, true}) {
    TriangleMesh mesh = ball(3.0);
    mesh.triangles.erase(mesh.triangles.begin() + 100);
    const std::vector<Triangle> outward = mesh.triangles;
    if (is_reversed) turn(mesh);
    orientOutward(mesh);
    EXPECT_EQ(mesh.triangles, outward);
    EXPECT_NEAR(enclosedVolume(mesh), volume, 0.01 * volume);
  }
  TriangleMesh mixed = ball(3.0);
  mixed.triangles.erase(mixed.triangles.begin() + 100);
  const std::vector<Triangle> outward = mixed.triangles;
  for (std::size_t t = 0; t < mixed.triangles.size(); t += 3) std::swap(mixed.triangles[t][1], mixed.triangles[t][2]);
  orientOutward(mixed);
  EXPECT_NEAR(enclosedVolume(mixed), volume, 0.01 * volume);
}

// Which side of a dome is its outside is for who made it to say.
TEST(OrientOutward, OpenPartsStay) {
  for (const int last : {6, 12, 20}) {
    TriangleMesh mesh = ball(0.0, last);
    turn(mesh);
    const std::vector<Triangle> before = mesh.triangles;
    orientOutward(mesh);
    EXPECT_EQ(mesh.triangles, before) << last;
  }
}

// Together both sides of each face enclose nothing: refused as "an open sheet, or thinner than a hundredth of its length".
TEST(OrientOutward, OfAClosedPartThatIsThereBothWaysRoundOneIsLeft) {
  const TriangleMesh once = ball(0.0);
  TriangleMesh twice = once;
  turn(twice);
  twice.triangles.insert(twice.triangles.end(), once.triangles.begin(), once.triangles.end());
  for (Triangle& t : twice.triangles) t = {t[1], t[2], t[0]};
  orientOutward(twice);
  EXPECT_EQ(twice.triangles.size(), once.triangles.size());
  EXPECT_TRUE(isClosedAndOriented(twice));
  EXPECT_NEAR(enclosedVolume(twice), enclosedVolume(once), 1e-12);
}

TEST(OrientOutward, AFaceBetweenTwoSolidsStaysTwice) {
  TetrahedronShape shape;
  shape.vertices.emplace_back(-1.0, 0.0, 0.0);
  for (const Triangle& t : {Triangle{0, 1, 2}, {0, 3, 1}, {0, 2, 3}, {1, 3, 2}}) {
    Triangle mirrored = t;
    for (int& v : mirrored) v = v == 1 ? 4 : v;
    shape.triangles.push_back(mirrored);
  }
  TriangleMesh mesh{NodalVectors(3, 5), shape.triangles};
  for (int v = 0; v < 5; ++v) mesh.vertices.col(v) = shape.vertices[static_cast<std::size_t>(v)];
  orientOutward(mesh);
  EXPECT_EQ(mesh.triangles.size(), 8U);
  EXPECT_NEAR(enclosedVolume(mesh), 2.0, 1e-12);
}

}  // namespace mesh_cleanup_test
}  // namespace tissue_contact
