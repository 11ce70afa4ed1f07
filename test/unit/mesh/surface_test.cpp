// What triangles share, and surfaces that follow their nodes.
#include <gtest/gtest.h>

#include <algorithm>
#include <stdexcept>
#include <vector>

#include "mesh/surface/moving_surface.h"
#include "unit/contact/contact_test_utilities.h"

namespace tissue_contact::contact_test {
namespace surface_test {

TEST(EdgeTable, NamesBothTrianglesOfAnEdgeAndTheWayTheyRunIt) {
  const EdgeTable table({{0, 1, 2}, {2, 1, 3}});
  ASSERT_EQ(table.size(), 5u);
  for (int t = 0; t < 2; ++t) {
    for (int k = 0; k < 3; ++k) {
      const EdgeTable::Edge& edge = table[table.edgesOf(t)[k]];
      const EdgeUse* const own = table.usesOf(edge).begin() + (edge.count == 2 ? t : 0);
      EXPECT_EQ(own->triangle, t);
      EXPECT_EQ(own->side, k);
    }
  }
  const EdgeTable::Edge& shared = table[table.edgesOf(0)[1]];
  EXPECT_EQ(shared.nodes, (std::array<int, 2>{1, 2}));
  ASSERT_EQ(table.usesOf(shared).size(), 2);
  EXPECT_TRUE(table.usesOf(shared)[0].forward);
  EXPECT_FALSE(table.usesOf(shared)[1].forward);
  for (std::size_t i = 1; i < table.size(); ++i) {
    EXPECT_LT(table[static_cast<int>(i) - 1].nodes, table[static_cast<int>(i)].nodes);
  }
}

TEST(EdgeTable, LengthsCountEachEdgeOnceWhateverTheOrderOfCorners) {
  // A 3-4-5 triangle and its mirror image over the longest side: four outer sides of 3 and 4, the shared one of 5.
  NodalVectors x(3, 4);
  x << 0, 4, 0, 4, 0, 0, 3, 3, 0, 0, 0, 0;
  for (const Triangle& first : {Triangle{0, 1, 2}, Triangle{1, 2, 0}, Triangle{2, 0, 1}}) {
    const EdgeLengths lengths = edgeLengths(x, {first, {2, 1, 3}});
    EXPECT_EQ(lengths.count, 5u);
    EXPECT_DOUBLE_EQ(lengths.sum_m, 19.0);
  }
  EXPECT_EQ(edgeLengths(x, {}).count, 0u);
}

TEST(TriangleTree, FindsExactlyTheOverlappingBoxesAfterRefit) {
  Surface block = boxSurface({0.1, 0.1, 0.03}, {12, 9, 4});
  TriangleTree tree(block.nodes, block.triangles);
  Random random(42);
  std::size_t found_total = 0;
  for (int i = 0; i < 50; ++i) {
    for (Eigen::Index n = 0; n < block.nodes.cols(); ++n) block.nodes.col(n) += random.vector(2e-3);
    tree.refit(block.nodes);
    const Vector3 low = random.vector(0.1);
    const Eigen::AlignedBox3d box(low, Vector3(low + Vector3::Constant(0.06)));
    std::vector<int> expected;
    for (std::size_t t = 0; t < block.triangles.size(); ++t) {
      Eigen::AlignedBox3d around;
      for (const int node : block.triangles[t]) around.extend(Vector3(block.nodes.col(node)));
      if (around.intersects(box)) expected.push_back(static_cast<int>(t));
    }
    std::vector<int> found;
    tree.overlapping(box, found);
    EXPECT_EQ(found, expected);
    found_total += found.size();
  }
  EXPECT_GT(found_total, 500u);
}

TEST(MovingSurface, FindsTrianglesWhereTheyAreNowHoweverSmallItsMoves) {
  const Surface block = boxSurface({0.1, 0.1, 0.03}, {8, 8, 3});
  const SharedSurfaces shared = shareSurfaces({{block.triangles, block.fixed()}}, {block.nodes});
  MovingSurface& surface = shared->front();
  Random random(45);
  NodalVectors x = block.nodes;
  std::size_t found_total = 0;
  for (const double move_m : {1e-5, 1e-4, 4e-4, 3e-3}) {
    for (int i = 0; i < 20; ++i) {
      for (Eigen::Index n = 0; n < x.cols(); ++n) x.col(n) += random.vector(move_m);
      surface.place(x);
      // The box ends at a corner's very coordinates, or so little before them that only round-off tells.
      const Vector3 p = Vector3(x.col(i)) - Vector3::Constant(i % 2 == 0 ? 0.0 : 1e-14);
      const Eigen::AlignedBox3d box(p - Vector3(0.01, 0.01, 0.01), p);
      std::vector<int> expected;
      for (std::size_t t = 0; t < block.triangles.size(); ++t) {
        Eigen::AlignedBox3d around;
        for (const int node : block.triangles[t]) around.extend(Vector3(x.col(node)));
        if (around.intersects(box)) expected.push_back(static_cast<int>(t));
      }
      std::vector<int> found;
      surface.overlapping(box, found);
      EXPECT_EQ(found, expected);
      found_total += found.size();
    }
  }
  EXPECT_GT(found_total, 200u);
}

TEST(MovingSurface, IsWhereItWasPlacedLastWhateverCameBefore) {
  const Surface block = boxSurface({0.1, 0.1, 0.03}, {4, 4, 2});
  const SharedSurfaces shared = shareSurfaces({{block.triangles, block.fixed()}}, {block.nodes});
  MovingSurface& surface = shared->front();
  Random random(44);
  NodalVectors x = block.nodes;
  for (int i = 0; i < 10; ++i) {
    for (Eigen::Index n = 0; n < x.cols(); ++n) x.col(n) += random.vector(2e-3);
    for (int again = 0; again < 2; ++again) {
      surface.place(x);
      MovingSurface fresh(0, {block.triangles, block.fixed()}, block.nodes);
      fresh.place(x);
      EXPECT_EQ(surface.box().min(), x.rowwise().minCoeff());
      EXPECT_EQ(surface.box().max(), x.rowwise().maxCoeff());
      for (int t = 0; t < static_cast<int>(block.triangles.size()); ++t) EXPECT_EQ(surface.normal(t), fresh.normal(t));
    }
  }
  EXPECT_EQ(surface.rest(), block.nodes);
  EXPECT_THROW(surface.place(NodalVectors::Zero(3, 2)), std::invalid_argument);
  EXPECT_THROW(placeAll(*shared, {}), std::invalid_argument);
}

// Nodes 0 and 1 are fixed, 2 is not: a point belongs to what is fixed where less than a quarter of it moves.
TEST(MovingSurface, APointIsHeldWhereHardlyAnyOfItMoves) {
  NodalVectors x(3, 3);
  x << 0, 1, 0, 0, 0, 1, 0, 0, 0;
  const MovingSurface surface(0, {{{0, 1, 2}}, {true, true, false}}, x);
  const auto held = [&](double a, double b, double c) { return surface.isHeld({0, 1, 2}, Vector3(a, b, c)); };
  EXPECT_FALSE(held(0.0, 0.0, 1.0));
  EXPECT_FALSE(held(0.7, 0.0, 0.3));
  EXPECT_TRUE(held(0.8, 0.0, 0.2));
  EXPECT_TRUE(held(0.5, 0.499999, 1e-6));
  EXPECT_TRUE(held(1.0, 0.0, 0.0));
}

TEST(MovingSurface, TheHeldLineBordersOnWhatMoves) {
  NodalVectors x(3, 3);
  x << 0, 1, 0, 0, 0, 1, 0, 0, 0;
  for (const std::vector<bool>& fixed :
       {std::vector<bool>{true, true, false}, {false, true, false}, {false, false, false}, {true, true, true}}) {
    const MovingSurface surface(0, {{{0, 1, 2}}, fixed}, x);
    Matrix3 corners;
    const auto count = std::count(fixed.begin(), fixed.end(), true);
    ASSERT_EQ(surface.findHeldLine(0, corners), count == 1 || count == 2);
    if (count == 0 || count == 3) continue;
    for (int i = 0; i < 3; ++i) {
      EXPECT_DOUBLE_EQ(corners.col(i).sum(), 1.0);
      EXPECT_FALSE(surface.isHeld({0, 1, 2}, corners.col(i)));
      double moving = 0.0;
      for (int k = 0; k < 3; ++k) moving += fixed[static_cast<std::size_t>(k)] ? 0.0 : corners(k, i);
      EXPECT_DOUBLE_EQ(moving, i == 0 ? 1.0 : 0.25);
    }
  }
}

}  // namespace surface_test
}  // namespace tissue_contact::contact_test
