/// What only the corotational model has: rotations, and a tangent that follows them.
#include "tissue_contact/tissue/tet_elasticity.h"

#include <gtest/gtest.h>

#include <Eigen/SVD>
#include <random>

#include "validation/elasticity_helpers.h"
#include "tissue_contact/tissue/tet_mesh.h"

namespace tissue_contact {
namespace {

TEST(Corotational, TangentFollowsRotationAndLagsByItsThreshold) {
  BlockDescription block;
  block.size_m = Vector3(0.03, 0.02, 0.02);
  block.cells = {2, 2, 2};
  const TetMesh mesh = makeBlockMesh(block);
  const TetElasticity elasticity(mesh.positions, mesh.tetrahedra, std::vector<bool>(mesh.positions.cols(), false),
                                 MaterialDescription{ElasticModel::kCorotational, 5e3, 0.4, 1000.0});
  const auto state = elasticity.makeState();
  const Eigen::MatrixXd K_rest = dense(state->stiffness);
  NodalVectors f(3, mesh.positions.cols());
  const auto turned = [&](double angle) {
    const Matrix3 Q = Eigen::AngleAxisd(angle, Vector3::UnitZ()).toRotationMatrix();
    elasticity.update(Q * mesh.positions, *state, f);
    Eigen::MatrixXd Q_all = Eigen::MatrixXd::Zero(K_rest.rows(), K_rest.cols());
    for (Eigen::Index i = 0; i < K_rest.rows(); i += 3) Q_all.block<3, 3>(i, i) = Q;
    return Eigen::MatrixXd(Q_all * K_rest * Q_all.transpose());
  };
  turned(0.5 * TetElasticity::kTangentAngle);
  EXPECT_EQ(dense(state->stiffness), K_rest);
  const Eigen::MatrixXd expected = turned(0.7);
  EXPECT_LE((dense(state->stiffness) - expected).cwiseAbs().maxCoeff(), 1e-12 * K_rest.cwiseAbs().maxCoeff());
}

TEST(NearestRotation, IsThePolarFactorForAnyGuess) {
  std::mt19937 random(7);
  std::uniform_real_distribution<double> uniform(-1.0, 1.0);
  for (int sample = 0; sample < 5000; ++sample) {
    Matrix3 F;
    for (int i = 0; i < 9; ++i) F.data()[i] = uniform(random);
    const Eigen::JacobiSVD<Matrix3> svd(F, Eigen::ComputeFullU | Eigen::ComputeFullV);
    const double det = (svd.matrixU() * svd.matrixV().transpose()).determinant();
    // The nearest rotation is not unique when the two smallest singular values cancel (inverted) or both vanish.
    const Vector3& sigma = svd.singularValues();
    if (sigma[1] + det * sigma[2] < 1e-2) continue;
    const Matrix3 expected = svd.matrixU() * Vector3(1.0, 1.0, det).asDiagonal() * svd.matrixV().transpose();
    const Quaternion guess =
        Quaternion(uniform(random), uniform(random), uniform(random), uniform(random)).normalized();
    const Matrix3 R = nearestRotation(F, guess).toRotationMatrix();
    ASSERT_LE((R - expected).norm(), 1e-11) << "singular values " << sigma.transpose() << ", det " << det;
  }
}

}  // namespace
}  // namespace tissue_contact
