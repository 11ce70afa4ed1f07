/// Which bodies are convex, and while which deformation they cannot touch themselves.
#include "tissue_contact/mesh/convex_body.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
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
