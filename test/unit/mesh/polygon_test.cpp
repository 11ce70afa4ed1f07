#include "mesh/reader/polygon.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <limits>
#include <random>
#include <string>
#include <vector>

#include "mesh_fixture.h"
#include "unit/instrument/instrument_fixture.h"

namespace tissue_contact {
namespace polygon_test {

using Outline = std::vector<Vector2>;

Outline comb(int teeth) {
  Outline outline = {{0, -2}, {2.0 * teeth, -2}};
  for (double x = 2.0 * teeth; x > 0; x -= 2)
    outline.insert(outline.end(), {{x, 0}, {x - 1, 0}, {x - 1, 1}, {x - 2, 1}});
  return outline;
}

/// Columns of whole heights, none or one more on each other: many corners in a line.
Outline skyline(std::mt19937& random) {
  Outline outline = {{0, -1}, {12, -1}};
  for (int x = 12; x > 0; --x) {
    const double height = static_cast<double>(random() % 3);
    outline.insert(outline.end(), {{1.0 * x, height}, {x - 1.0, height}});
  }
  outline.emplace_back(0, -0.5);
  Outline clean;
  for (const Vector2& p : outline) {
    if (clean.empty() || clean.back() != p) clean.push_back(p);
  }
  return clean;
}

std::vector<Outline> outlines() {
  std::vector<Outline> all = {
      {{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {0, 2}},                                                  // L
      {{1, 0}, {2, 0}, {2, 2}, {3, 2}, {3, 3}, {0, 3}, {0, 2}, {1, 2}},                                  // T
      {{0, 0}, {3, 0}, {3, 2}, {2, 2}, {2, 1}, {1, 1}, {1, 2}, {0, 2}},                                  // U
      {{0, 0}, {1, 0}, {1, 1}, {2, 1}, {2, 0}, {3, 0}, {3, 3}, {2, 3}, {2, 2}, {1, 2}, {1, 3}, {0, 3}},  // H
      {{0, 0}, {2, 0}, {2, 1}, {1, 1}, {1, 2}, {2, 2}, {2, 3}, {1, 3}, {1, 4}, {2, 4}, {2, 5}, {0, 5}},  // E
      {{1, 0}, {2, 0}, {2, 1}, {3, 1}, {3, 2}, {2, 2}, {2, 3}, {1, 3}, {1, 2}, {0, 2}, {0, 1}, {1, 1}},  // plus
      {{0, 0},
       {3, 0},
       {3, .5},
       {1.75, .5},
       {1.75, 2.5},
       {3, 2.5},
       {3, 3},
       {0, 3},
       {0, 2.5},
       {1.25, 2.5},
       {1.25, .5},
       {0, .5}},
      {{0, 0}, {4, 0}, {4, 1}, {3, 1}, {3, 2}, {2, 2}, {2, 3}, {1, 3}, {1, 4}, {0, 4}},  // stairs
      {{0, 0}, {1, 0}, {2, 0}, {3, 0}, {3, 1}, {3, 2}, {2, 2}, {1, 2}, {0, 2}, {0, 1}},  // a box, its edges divided
      {{0, 0}, {1, 0}, {2, 0}, {3, 0}, {2, 1}, {1, 2}, {0, 3}, {0, 1.5}},                // a triangle, too
      {{0, 0}, {2, 1}, {0, 2}, {1, 1}},                                                  // a dart
      {{0, 0}, {1, 0}, {2, 0}, {0, 2}},                                                  // a triangle of four corners
      // With a hole, joined with the border by an edge there and back.
      {{0, 0}, {4, 0}, {4, 4}, {0, 4}, {0, 0}, {1, 1}, {1, 3}, {3, 3}, {3, 1}, {1, 1}},
      comb(1),
      comb(4),
      comb(20)};
  std::mt19937 random(1);
  for (int i = 0; i < 20; ++i) all.push_back(skyline(random));
  return all;
}

double twiceArea(const Vector2& a, const Vector2& b, const Vector2& c) {
  return (b - a).x() * (c - a).y() - (b - a).y() * (c - a).x();
}

/// All triangles the right way round, and together as large as the polygon: so none are on each other.
void expectCut(const Outline& outline, const std::vector<Triangle>& triangles) {
  ASSERT_EQ(triangles.size(), outline.size() - 2);
  double whole = 0.0;
  for (std::size_t i = 1; i + 1 < outline.size(); ++i) whole += twiceArea(outline[0], outline[i], outline[i + 1]);
  double sum = 0.0;
  for (const Triangle& t : triangles) {
    const Vector2 corners[] = {outline[t[0]], outline[t[1]], outline[t[2]]};
    const double area = twiceArea(corners[0], corners[1], corners[2]);
    EXPECT_GT(area, 1e-3) << t[0] << " " << t[1] << " " << t[2];
    sum += area;
    for (const Vector2& q : outline) {  // which lies on an edge: a border that no other triangle has
      if (q == corners[0] || q == corners[1] || q == corners[2]) continue;
      double nearest = std::numeric_limits<double>::infinity();
      for (int k = 0; k < 3; ++k) nearest = std::min(nearest, twiceArea(corners[k], corners[(k + 1) % 3], q));
      EXPECT_LT(nearest, -1e-3) << t[0] << " " << t[1] << " " << t[2] << " at " << q.transpose();
    }
  }
  EXPECT_NEAR(sum, whole, 1e-9 * whole);
}

/// In space, in single precision, as files are read.
std::vector<Vector3> inPlane(const Outline& outline, const Eigen::Quaterniond& R, const Vector3& p) {
  std::vector<Vector3> corners;
  for (const Vector2& q : outline) corners.push_back((R * Vector3(q.x(), q.y(), 0) + p).cast<float>().cast<double>());
  return corners;
}

// As assimp 5.2.5 triangulates them: stairs of area 11.5 for 10, the I-beam's 5.25 for 4, and the others with corners on triangles' edges.
TEST(CutPolygon, ConcaveOnesAndCornersInALineInAnyPlane) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> part(-1.0, 1.0);
  std::vector<Eigen::Quaterniond> turns = {Eigen::Quaterniond(1, 0, 0, 0), Eigen::Quaterniond(0, 1, 0, 0),
                                           Eigen::Quaterniond(0, 0, 1, 0), Eigen::Quaterniond(1, 1, 1, 1).normalized(),
                                           Eigen::Quaterniond(1, -1, 1, -1).normalized()};
  while (turns.size() < 25) {
    turns.emplace_back(Eigen::Quaterniond(part(random), part(random), part(random), part(random)).normalized());
  }
  for (const Outline& given : outlines()) {
    for (std::size_t first = 0; first < given.size(); first += 1 + given.size() / 8) {
      Outline outline(given.begin() + static_cast<std::ptrdiff_t>(first), given.end());
      outline.insert(outline.end(), given.begin(), given.begin() + static_cast<std::ptrdiff_t>(first));
      for (const Eigen::Quaterniond& turn : turns) {
        SCOPED_TRACE(testing::Message() << given.size() << " corners, from " << first << " turned "
                                        << turn.coeffs().transpose());
        expectCut(outline,
                  cutPolygon(inPlane(outline, turn, 20.0 * Vector3(part(random), part(random), part(random)))));
      }
    }
  }
}

TEST(CutPolygon, TrianglesStayAndQuadranglesAreCutFromTheCornerThatIsNotConvex) {
  const auto cut = [](const Outline& outline) { return cutPolygon(inPlane(outline, {1, 0, 0, 0}, Vector3::Zero())); };
  using Cut = std::vector<Triangle>;
  EXPECT_EQ(cut({{0, 0}, {1, 0}, {0, 1}}), (Cut{{0, 1, 2}}));
  EXPECT_EQ(cut({{0, 0}, {0, 0}, {0, 1}}), (Cut{{0, 1, 2}}));
  EXPECT_EQ(cut({{0, 0}, {1, 0}, {1, 1}, {0, 1}}), (Cut{{0, 1, 2}, {0, 2, 3}}));
  EXPECT_EQ(cut({{0, 0}, {2, 1}, {0, 2}, {1, 1}}), (Cut{{3, 0, 1}, {3, 1, 2}}));
  EXPECT_EQ(cut({{0, 0}, {1, 0}, {2, 0}, {0, 1}}), (Cut{{1, 2, 3}, {1, 3, 0}}));
}

TEST(CutPolygon, EndsForWhatIsNone) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  std::mt19937 random(3);
  Outline tangle;
  for (int i = 0; i < 200; ++i)
    tangle.emplace_back(static_cast<double>(random() % 100), static_cast<double>(random() % 100));
  const std::vector<Outline> all = {{{0, 0}, {1, 1}, {1, 0}, {0, 1}},                          // crosses itself
                                    {{0, 0}, {1, 0}, {2, 0}, {3, 0}, {4, 0}},                  // has no area
                                    Outline(7, Vector2(1, 1)),                                 // is a point
                                    {{0, 0}, {2, 0}, {2, 0}, {2, 2}, {0, 2}, {1, 3}, {0, 2}},  // has a spike
                                    {{0, 0}, {nan, 0}, {2, 0}, {2, 2}, {0, 2}},
                                    tangle};
  for (const Outline& outline : all) {
    EXPECT_EQ(cutPolygon(inPlane(outline, {1, 0, 0, 0}, Vector3::Zero())).size(), outline.size() - 2);
  }
}

TEST(CutPolygon, ManyCornersAreCutAndWhatTakesTooLongIsRefused) {
  const Outline outline = comb(500);
  expectCut(comb(100), cutPolygon(inPlane(comb(100), {1, 0, 0, 0}, Vector3::Zero())));
  EXPECT_EQ(cutPolygon(inPlane(outline, {1, 0, 0, 0}, Vector3::Zero())).size(), 2000u);
  std::vector<Vector3> line;  // has no ear anywhere: all are looked at each time
  for (int i = 0; i < 20000; ++i) line.emplace_back(i, 0, 0);
  expectContains(refusal([&] { cutPolygon(line); }), {"20000 corners", "too long", "Triangulate"});
}

}  // namespace polygon_test
}  // namespace tissue_contact
