/// @file
/// makeBlockMesh: node order, exact size, grading, and that the tetrahedra fill the block without gap or overlap.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <map>
#include <random>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "support/refusal.h"
#include "tissue_contact/mesh/tet_mesh.h"

namespace tissue_contact {
namespace block_mesh_test {

using FineAt = AxisGrading::FineAt;

BlockDescription makeBlock(const Vector3& size, const std::array<int, 3>& cells) { return {size, cells, {}}; }

/// Coordinates along an axis: those of the nodes on the block's edge.
std::vector<double> axisNodes(const TetMesh& mesh, const std::array<int, 3>& cells, int axis) {
  const Eigen::Index stride = axis == 0 ? 1 : axis == 1 ? cells[0] + 1 : (cells[0] + 1) * (cells[1] + 1);
  std::vector<double> x;
  for (int i = 0; i <= cells[static_cast<std::size_t>(axis)]; ++i) x.push_back(mesh.positions(axis, i * stride));
  return x;
}

std::vector<double> lengths(const std::vector<double>& x) {
  std::vector<double> h;
  for (std::size_t i = 1; i < x.size(); ++i) h.push_back(x[i] - x[i - 1]);
  return h;
}

double volumeByDivergenceTheorem(const NodalVectors& x, const std::vector<Triangle>& surface) {
  double volume = 0.0;
  for (const Triangle& t : surface) volume += x.col(t[0]).dot(x.col(t[1]).cross(x.col(t[2]))) / 6.0;
  return volume;
}

/// Each edge is walked once in each direction: closed, and all faces turned the same way.
void expectClosed(const std::vector<Triangle>& surface) {
  std::map<std::pair<int, int>, int> walks;
  for (const Triangle& t : surface) {
    for (std::size_t i = 0; i < 3; ++i) ++walks[{t[i], t[(i + 1) % 3]}];
  }
  for (const auto& [edge, count] : walks) {
    ASSERT_EQ(count, 1) << "edge " << edge.first << " " << edge.second;
    ASSERT_EQ(walks.count({edge.second, edge.first}), 1U) << "edge " << edge.first << " " << edge.second;
  }
}

TEST(BlockMesh, NodesRunAlongXThenYThenZ) {
  const TetMesh mesh = makeBlockMesh(makeBlock({0.4, 0.2, 0.1}, {4, 2, 1}));
  ASSERT_EQ(mesh.positions.cols(), 5 * 3 * 2);
  EXPECT_TRUE(mesh.positions.col(0).isApprox(Vector3(-0.2, -0.1, 0.0)));
  EXPECT_TRUE(mesh.positions.col(1).isApprox(Vector3(-0.1, -0.1, 0.0)));
  EXPECT_TRUE(mesh.positions.col(5).isApprox(Vector3(-0.2, 0.0, 0.0)));
  EXPECT_TRUE(mesh.positions.col(15).isApprox(Vector3(-0.2, -0.1, 0.1)));
  EXPECT_EQ(mesh.tetrahedra.size(), 5U * 4 * 2 * 1);
}

TEST(BlockMesh, OuterNodesLieExactlyOnTheFaces) {
  // 0.3 / 7 and the growth are no binary fractions: a running sum of cell lengths would miss the face.
  BlockDescription block = makeBlock({0.3, 0.7, 0.1}, {7, 6, 3});
  for (AxisGrading& grading : block.grading) grading = {1.3, FineAt::kMinimum};
  const TetMesh mesh = makeBlockMesh(block);
  EXPECT_EQ(mesh.positions.row(0).minCoeff(), -0.15);
  EXPECT_EQ(mesh.positions.row(0).maxCoeff(), 0.15);
  EXPECT_EQ(mesh.positions.row(1).minCoeff(), -0.35);
  EXPECT_EQ(mesh.positions.row(1).maxCoeff(), 0.35);
  EXPECT_EQ(mesh.positions.row(2).minCoeff(), 0.0);
  EXPECT_EQ(mesh.positions.row(2).maxCoeff(), 0.1);
}

TEST(BlockMesh, CellsGrowAwayFromTheFineSide) {
  const std::array<int, 3> cells = {6, 7, 5};
  BlockDescription block = makeBlock({1.0, 2.0, 3.0}, cells);
  block.grading = {{{1.5, FineAt::kMinimum}, {1.2, FineAt::kMaximum}, {2.0, FineAt::kMinimum}}};
  const TetMesh mesh = makeBlockMesh(block);
  const std::array<double, 3> ratios = {1.5, 1.0 / 1.2, 2.0};
  for (int axis = 0; axis < 3; ++axis) {
    const std::vector<double> h = lengths(axisNodes(mesh, cells, axis));
    for (std::size_t i = 1; i < h.size(); ++i) {
      EXPECT_NEAR(h[i] / h[i - 1], ratios[static_cast<std::size_t>(axis)], 1e-12) << "axis " << axis << " cell " << i;
    }
  }
}

TEST(BlockMesh, CentredGradingIsSymmetricForOddAndEvenCells) {
  for (const int count : {1, 2, 3, 4, 7, 8}) {
    const std::array<int, 3> cells = {count, 1, count};
    BlockDescription block = makeBlock({0.3, 0.1, 0.7}, cells);
    block.grading[0] = block.grading[2] = {1.4, FineAt::kCenter};
    const TetMesh mesh = makeBlockMesh(block);
    const std::vector<double> x = axisNodes(mesh, cells, 0);
    const std::vector<double> h = lengths(x);
    const auto n = static_cast<std::size_t>(count);
    for (std::size_t i = 0; i <= n; ++i) EXPECT_EQ(x[i], -x[n - i]) << count << " cells, node " << i;
    // Towards the middle each cell is 1.4 times shorter; an even number has two finest cells, an odd one has one.
    for (std::size_t i = 1; i <= (n - 1) / 2; ++i) EXPECT_NEAR(h[i - 1] / h[i], 1.4, 1e-12) << count << " cells";
    const std::vector<double> hz = lengths(axisNodes(mesh, cells, 2));
    for (std::size_t i = 0; i < n; ++i) EXPECT_NEAR(hz[i], hz[n - 1 - i], 1e-15) << count << " cells";
  }
}

TEST(BlockMesh, EvenSpacingWithoutGrowth) {
  const std::array<int, 3> cells = {5, 4, 3};
  const TetMesh mesh = makeBlockMesh(makeBlock({0.5, 0.4, 0.3}, cells));
  for (int axis = 0; axis < 3; ++axis) {
    for (const double h : lengths(axisNodes(mesh, cells, axis))) EXPECT_NEAR(h, 0.1, 1e-15);
  }
}

TEST(BlockMesh, NeighbouringCellsAreMirrored) {
  // In a 2 x 1 x 1 block the split of the right cell is the left one's mirror image at x = 0.
  const TetMesh mesh = makeBlockMesh(makeBlock({2.0, 1.0, 1.0}, {2, 1, 1}));
  const auto mirrored = [](int node) { return node / 3 * 3 + (2 - node % 3); };
  std::set<std::set<int>> left;
  std::set<std::set<int>> right;
  for (std::size_t i = 0; i < 10; ++i) {
    const Tetrahedron& tet = mesh.tetrahedra[i];
    if (i < 5) left.insert({tet.begin(), tet.end()});
    if (i >= 5) right.insert({mirrored(tet[0]), mirrored(tet[1]), mirrored(tet[2]), mirrored(tet[3])});
  }
  EXPECT_EQ(left, right);
}

TEST(BlockMesh, FillsTheBlockWithAClosedOutwardSurface) {
  std::mt19937 random(20240611);
  const FineAt sides[] = {FineAt::kMinimum, FineAt::kCenter, FineAt::kMaximum};
  for (int trial = 0; trial < 40; ++trial) {
    const auto pick = [&](int low, int high) { return std::uniform_int_distribution<int>(low, high)(random); };
    const auto real = [&](double low, double high) {
      return std::uniform_real_distribution<double>(low, high)(random);
    };
    BlockDescription block =
        makeBlock({real(0.01, 1), real(0.01, 1), real(0.01, 1)}, {pick(1, 6), pick(1, 6), pick(1, 6)});
    for (AxisGrading& grading : block.grading) grading = {real(1.0, 1.8), sides[pick(0, 2)]};
    const TetMesh mesh = makeBlockMesh(block);
    ASSERT_NO_THROW(checkTetMesh(mesh, "block"));  // among others: every volume is positive
    double volume = 0.0;
    for (const Tetrahedron& tet : mesh.tetrahedra) volume += signedVolume(mesh.positions, tet);
    const double expected = block.size_m.prod();
    EXPECT_NEAR(volume, expected, 1e-13 * expected);
    const std::vector<Triangle> surface = boundaryTriangles(mesh.tetrahedra);
    const auto& n = block.cells;
    EXPECT_EQ(surface.size(), 4U * static_cast<unsigned>(n[0] * n[1] + n[1] * n[2] + n[2] * n[0]));
    expectClosed(surface);
    EXPECT_NEAR(volumeByDivergenceTheorem(mesh.positions, surface), expected, 1e-12 * expected);
  }
}

void expectRefusedBlock(const BlockDescription& block, const std::string& words) {
  expectRefusal([&] { makeBlockMesh(block); }, {words});
}

TEST(BlockMesh, RefusesBadSizesCellsAndGrading) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const double inf = std::numeric_limits<double>::infinity();
  for (const double bad : {0.0, -1.0, nan, inf})
    expectRefusedBlock(makeBlock({1, bad, 1}, {1, 1, 1}), "block size along y is");
  for (const int bad : {0, -3}) expectRefusedBlock(makeBlock({1, 1, 1}, {1, 1, bad}), "block cells along z is");
  for (const double bad : {0.99, -1.0, nan, inf}) {
    BlockDescription block = makeBlock({1, 1, 1}, {2, 2, 2});
    block.grading[0].growth = bad;
    expectRefusedBlock(block, "block growth along x is");
  }
}

TEST(BlockMesh, RefusesWhatWouldNotFitInMemory) {
  const int largest = std::numeric_limits<int>::max();
  expectRefusedBlock(makeBlock({1, 1, 1}, {1001, 1000, 1}), "at most 2000000");
  expectRefusedBlock(makeBlock({1, 1, 1}, {largest, largest, largest}), "at most 2000000");
}

TEST(BlockMesh, RefusesGrowthThatFlattensCells) {
  BlockDescription block = makeBlock({1, 1, 1}, {2, 2, 26});
  block.grading[2] = {2.0, FineAt::kMinimum};
  expectRefusedBlock(block, "block growth along z is 2");
  block.grading[2].fine_at = FineAt::kMaximum;
  expectRefusedBlock(block, "block growth along z is 2");
  block.grading[2].fine_at = FineAt::kCenter;  // 2^12 only: cells grow over half of the block
  EXPECT_NO_THROW(checkTetMesh(makeBlockMesh(block), "block"));
}

TEST(BlockMesh, OfSixTetrahedraPerCellFillsTheBlockAndMirrorsNeighbours) {
  const TetMesh mesh = makeBlockMesh(makeBlock({0.3, 0.2, 0.1}, {3, 2, 2}), BlockSplit::kSix);
  ASSERT_EQ(mesh.tetrahedra.size(), 72U);
  for (const Tetrahedron& tet : mesh.tetrahedra) EXPECT_NEAR(signedVolume(mesh.positions, tet), 0.006 / 72.0, 1e-15);
  EXPECT_NO_THROW(checkTetMesh(mesh, "six"));
  const std::vector<Triangle> surface = boundaryTriangles(mesh.tetrahedra);
  EXPECT_EQ(surface.size(), 2U * 2U * (3 * 2 + 3 * 2 + 2 * 2));  // no face within: neighbours agree on their diagonals
  expectClosed(surface);
  EXPECT_NEAR(volumeByDivergenceTheorem(mesh.positions, surface), 0.006, 1e-15);
}

}  // namespace block_mesh_test
}  // namespace tissue_contact
