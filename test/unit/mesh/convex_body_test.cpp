/// Which bodies are convex, and while which deformation they cannot touch themselves.
#include "tissue_contact/mesh/convex_body.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <random>

#include "tissue_contact/mesh/tet_mesh.h"

namespace tissue_contact {
namespace convex_body_test {

TetMesh makeBlock() {
  BlockDescription block;
  block.size_m = Vector3(0.06, 0.03, 0.02);
  block.cells = {6, 3, 2};
  block.grading[0] = {1.3, AxisGrading::FineAt::kCenter};
  return makeBlockMesh(block);
}

NodalVectors turned(const NodalVectors& x) {
  const Pose X = Eigen::Translation3d(0.3, -0.2, 5.0) * Eigen::AngleAxisd(1.1, Vector3(1.0, 2.0, 3.0).normalized());
  return (X.linear() * x).colwise() + X.translation();
}

/// Largest Frobenius norm of F - I, plainly.
double strain(const TetMesh& mesh, const NodalVectors& x) {
  double largest = 0.0;
  for (const Tetrahedron& nodes : mesh.tetrahedra) {
    Matrix3 D, D_rest;
    for (int i = 0; i < 3; ++i) {
      D.col(i) = x.col(nodes[i + 1]) - x.col(nodes[0]);
      D_rest.col(i) = mesh.positions.col(nodes[i + 1]) - mesh.positions.col(nodes[0]);
    }
    largest = std::max(largest, (D * D_rest.inverse() - Matrix3::Identity()).norm());
  }
  return largest;
}

TEST(ConvexBody, BlocksAreConvexHoweverTheyArePlaced) {
  const TetMesh mesh = makeBlock();
  EXPECT_TRUE(isConvex(mesh.positions, boundaryTriangles(mesh.tetrahedra)));
  EXPECT_TRUE(isConvex(turned(mesh.positions), boundaryTriangles(mesh.tetrahedra)));
}

TEST(ConvexBody, DentedCutAndSplitBodiesAreNot) {
  TetMesh mesh = makeBlock();
  NodalVectors dented = mesh.positions;
  for (Eigen::Index i = 0; i < dented.cols(); ++i) {
    if (dented(2, i) > 0.019 && dented.col(i).head<2>().norm() < 0.006) dented(2, i) -= 1e-6;
  }
  ASSERT_NE(dented, mesh.positions);
  EXPECT_FALSE(isConvex(dented, boundaryTriangles(mesh.tetrahedra)));
  std::vector<Tetrahedron> corner, gap;  // an L, and two blocks side by side
  for (const Tetrahedron& nodes : mesh.tetrahedra) {
    Vector3 middle = Vector3::Zero();
    for (const int node : nodes) middle += 0.25 * mesh.positions.col(node);
    if (middle.x() < 0.01 || middle.z() < 0.01) corner.push_back(nodes);
    if (std::abs(middle.x()) > 0.004) gap.push_back(nodes);
  }
  EXPECT_FALSE(isConvex(mesh.positions, boundaryTriangles(corner)));
  EXPECT_FALSE(isConvex(mesh.positions, boundaryTriangles(gap)));
}

/// As the definition has it: every node behind every triangle.
bool isBehindAll(const NodalVectors& x, const std::vector<Triangle>& surface) {
  const double rounding = 1e-9 * (x.rowwise().maxCoeff() - x.rowwise().minCoeff()).norm();
  for (const Triangle& t : surface) {
    const Vector3 n = (x.col(t[1]) - x.col(t[0])).cross(x.col(t[2]) - x.col(t[0])).normalized();
    for (const Triangle& other : surface) {
      for (const int node : other) {
        if (!(n.dot(x.col(node) - x.col(t[0])) <= rounding)) return false;
      }
    }
  }
  return true;
}

// Ellipsoids, some of them with a node moved in or out, also such that it takes its row of triangles with it.
TEST(ConvexBody, TheEdgesTellWhatAllNodesAndTrianglesTell) {
  const TetMesh mesh = makeBlock();
  const std::vector<Triangle> surface = boundaryTriangles(mesh.tetrahedra);
  std::mt19937 random(7);
  std::uniform_real_distribution<double> uniform(0.0, 1.0);
  int convex = 0;
  for (int k = 0; k < 60; ++k) {
    NodalVectors x = mesh.positions;
    const Vector3 centre(0.0, 0.0, 0.01);
    for (Eigen::Index i = 0; i < x.cols(); ++i) {  // on spheres: no two triangles in one plane
      const Vector3 p = Vector3(x.col(i)) - centre;
      if (k % 3 > 0) x.col(i) = centre + 0.02 * p / std::max(p.norm(), 1e-6);
    }
    const double moved = k % 3 == 1 || k % 6 == 0 ? 0.0 : std::pow(10.0, -2.0 - 6.0 * uniform(random));
    x.col(surface[static_cast<std::size_t>(uniform(random) * static_cast<double>(surface.size()))][0]) *= 1.0 + moved;
    const bool expected = isBehindAll(x, surface);
    EXPECT_EQ(isConvex(turned(x), surface), expected) << k;
    convex += static_cast<int>(expected);
  }
  EXPECT_GT(convex, 5);
  EXPECT_LT(convex, 55);
}

TEST(ConvexBody, HollowDoubledAndRewoundSurfacesAreNot) {
  const TetMesh mesh = makeBlock();
  const std::vector<Triangle> once = boundaryTriangles(mesh.tetrahedra);
  const auto count = static_cast<int>(mesh.positions.cols());
  NodalVectors x(3, 2 * count);
  std::vector<Triangle> both = once, hollow = once;
  for (const Triangle& t : once) {
    both.push_back({t[0] + count, t[1] + count, t[2] + count});
    hollow.push_back({t[0] + count, t[2] + count, t[1] + count});
  }
  for (const double scale : {1.0, 0.5}) {
    x << mesh.positions, scale * mesh.positions;
    EXPECT_FALSE(isConvex(x, both)) << "each is convex at all its edges";
  }
  EXPECT_FALSE(isConvex(x, hollow));
}

// Along a groove's floor, two strips of triangles lower than the rounding: neighbours meet them at any angle, none is bent inwards, and the
// middle sees all from behind.
TEST(ConvexBody, AFoldBetweenLowTrianglesIsSeen) {
  constexpr double kLow = 1e-10;
  const std::vector<Vector3> nodes = {{0, 0, 0},
                                      {2, 0, 0},
                                      {2, 1, 0},
                                      {0, 1, 0},
                                      {0, 0, 1},
                                      {2, 0, 1},
                                      {2, 1, 1},
                                      {0, 1, 1},
                                      {1 - kLow, 0, 0.9 + 0.1 * kLow},
                                      {1 - kLow, 1, 0.9 + 0.1 * kLow},
                                      {1, 0, 0.9},
                                      {1, 1, 0.9},
                                      {1 + kLow, 0, 0.9 + 0.1 * kLow},
                                      {1 + kLow, 1, 0.9 + 0.1 * kLow}};
  const std::vector<Triangle> surface = {{0, 2, 1},  {0, 3, 2},   {0, 4, 3},   {3, 4, 7},  {1, 2, 5},    {2, 6, 5},
                                         {4, 8, 9},  {4, 9, 7},   {8, 10, 11}, {8, 11, 9}, {10, 12, 13}, {10, 13, 11},
                                         {12, 5, 6}, {12, 6, 13}, {0, 1, 10},  {0, 10, 8}, {0, 8, 4},    {1, 12, 10},
                                         {1, 5, 12}, {2, 3, 11},  {3, 9, 11},  {3, 7, 9},  {2, 11, 13},  {2, 13, 6}};
  NodalVectors x(3, static_cast<Eigen::Index>(nodes.size()));
  for (std::size_t i = 0; i < nodes.size(); ++i) x.col(static_cast<Eigen::Index>(i)) = nodes[i];
  EXPECT_FALSE(isConvex(x, surface));
}

// Stretched, bent and jittered, beyond the limit and back, in small ways and large: what is remembered must not change
// the answer.
TEST(ConvexBody, TellsWhetherTheLargestStrainIsBelowTheLimit) {
  const TetMesh mesh = makeBlock();
  ConvexBody body(mesh.positions, mesh.tetrahedra);
  std::mt19937 random(5);
  std::normal_distribution<double> normal(0.0, 1e-5);
  int below = 0;
  for (int k = 0; k < 1000; ++k) {
    const double amount = 0.5 * (1.0 - std::cos(0.02 * k));  // 0 to 1 and back, three times
    NodalVectors x = mesh.positions;
    for (Eigen::Index i = 0; i < x.cols(); ++i) {
      x(0, i) *= 1.0 + 0.2 * amount;
      x(2, i) += 12.0 * amount * x(0, i) * x(0, i);
      for (int axis = 0; axis < 3; ++axis) x(axis, i) += normal(random);
    }
    const bool expected = strain(mesh, x) < ConvexBody::kMostStrain;
    ASSERT_EQ(body.cannotFold(x), expected) << k << ": " << strain(mesh, x);
    below += static_cast<int>(expected);
  }
  EXPECT_GT(below, 100);
  EXPECT_LT(below, 900);
}

}  // namespace convex_body_test
}  // namespace tissue_contact
