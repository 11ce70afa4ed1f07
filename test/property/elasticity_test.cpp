/// What every elastic model must have: forces that are the gradient of an energy, a symmetric stiffness that is their
/// gradient, and no force for rigid motions.
#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>
#include <Eigen/SVD>
#include <random>
#include <stdexcept>

#include "tissue_contact/tissue/tet_elasticity.h"
#include "tissue_contact/tissue/tet_mesh.h"

namespace tissue_contact {
namespace {

class ElasticityProperty : public ::testing::TestWithParam<ElasticModel> {
 protected:
  ElasticityProperty() {
    BlockDescription block;
    block.size_m = Vector3(0.03, 0.02, 0.02);
    block.cells = {2, 2, 2};
    mesh = makeBlockMesh(block);
    free.assign(mesh.positions.cols(), false);
    material = {GetParam(), 5e3, 0.4, 1000.0};
  }

  NodalVectors forces(const Elasticity& elasticity, const NodalVectors& x) const {
    const auto made = elasticity.makeState();
    Elasticity::State& state = *made;
    NodalVectors f(3, x.cols());
    elasticity.update(x, state, f);
    return f;
  }

  NodalVectors perturbed(double size, unsigned seed) const {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> uniform(-size, size);
    NodalVectors x = mesh.positions;
    for (Eigen::Index i = 0; i < x.size(); ++i) x.data()[i] += uniform(random);
    return x;
  }

  static Eigen::MatrixXd dense(const BlockMatrix& K) {
    Eigen::MatrixXd A = Eigen::MatrixXd::Zero(3 * K.rows(), 3 * K.rows());
    for (int i = 0; i < K.rows(); ++i) {
      A.block<3, 3>(3 * i, 3 * i) = K.diagonal[i];
      for (int k = K.row_start[i]; k < K.row_start[i + 1]; ++k) A.block<3, 3>(3 * i, 3 * K.columns[k]) = K.values[k];
    }
    return A;
  }

  TetMesh mesh;
  std::vector<bool> free;
  MaterialDescription material;
};

TEST_P(ElasticityProperty, ForcesAreMinusTheEnergyGradient) {
  const TetElasticity elasticity(mesh.positions, mesh.tetrahedra, free, material);
  NodalVectors x = perturbed(2e-3, 4);
  const NodalVectors f = forces(elasticity, x);
  const double scale = f.cwiseAbs().maxCoeff();
  const double h =
      1e-7;  // central difference of a smooth energy: error h^2 f'' + round-off / h, both about 1e-7 of f here
  for (Eigen::Index i = 0; i < x.size(); ++i) {
    const double before = x.data()[i];
    x.data()[i] = before + h;
    const double above = elasticity.energy(x);
    x.data()[i] = before - h;
    const double below = elasticity.energy(x);
    x.data()[i] = before;
    ASSERT_NEAR(f.data()[i], -(above - below) / (2.0 * h), 1e-6 * scale);
  }
}

TEST_P(ElasticityProperty, StiffnessIsTheGradientOfTheForcesAtRest) {
  const TetElasticity elasticity(mesh.positions, mesh.tetrahedra, free, material);
  const Eigen::MatrixXd K = dense(elasticity.makeState()->stiffness);
  EXPECT_LE((K - K.transpose()).cwiseAbs().maxCoeff(), 1e-12 * K.cwiseAbs().maxCoeff());
  const double h = 1e-7;
  for (Eigen::Index i = 0; i < mesh.positions.size(); ++i) {
    NodalVectors above = mesh.positions;
    NodalVectors below = mesh.positions;
    above.data()[i] += h;
    below.data()[i] -= h;
    const NodalVectors difference = (forces(elasticity, above) - forces(elasticity, below)) / (2.0 * h);
    const Eigen::Map<const VectorX> column(difference.data(), difference.size());
    ASSERT_LE((column + K.col(i)).cwiseAbs().maxCoeff(), 1e-7 * K.cwiseAbs().maxCoeff());
  }
}

TEST_P(ElasticityProperty, StiffnessIsPositiveSemidefiniteWithSixRigidMotionsAtRest) {
  const TetElasticity elasticity(mesh.positions, mesh.tetrahedra, free, material);
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(dense(elasticity.makeState()->stiffness));
  const VectorX values = eigen.eigenvalues() / eigen.eigenvalues().maxCoeff();
  EXPECT_GE(values[0], -1e-12);
  EXPECT_LE(values[5], 1e-12);
  EXPECT_GE(values[6], 1e-6);
}

TEST_P(ElasticityProperty, TranslationGivesNoForce) {
  const TetElasticity elasticity(mesh.positions, mesh.tetrahedra, free, material);
  const NodalVectors x = mesh.positions.colwise() + Vector3(0.1, -0.2, 0.3);
  // Round-off of 0.3 m positions times stiffness E h = 5e3 * 0.01 N/m.
  EXPECT_LE(forces(elasticity, x).cwiseAbs().maxCoeff(), 1e-12);
}

TEST_P(ElasticityProperty, InternalForcesBalance) {
  const TetElasticity elasticity(mesh.positions, mesh.tetrahedra, free, material);
  const NodalVectors x = perturbed(3e-3, 5);
  const NodalVectors f = forces(elasticity, x);
  EXPECT_LE(f.rowwise().sum().norm(), 1e-12 * f.norm());
  if (GetParam() == ElasticModel::kLinear)
    return;  // linear elasticity has a moment of second order in the displacement
  Vector3 moment = Vector3::Zero();
  for (Eigen::Index i = 0; i < x.cols(); ++i) moment += Vector3(x.col(i)).cross(Vector3(f.col(i)));
  EXPECT_LE(moment.norm(), 1e-10 * f.norm() * x.norm());
}

INSTANTIATE_TEST_SUITE_P(Models, ElasticityProperty,
                         ::testing::Values(ElasticModel::kLinear, ElasticModel::kCorotational),
                         [](const auto& parameter) {
                           return std::string(parameter.param == ElasticModel::kLinear ? "Linear" : "Corotational");
                         });

class CorotationalProperty : public ElasticityProperty {};

TEST_P(CorotationalProperty, RotationGivesNoForceAndTurnsTheForces) {
  const TetElasticity elasticity(mesh.positions, mesh.tetrahedra, free, material);
  const Matrix3 Q = Eigen::AngleAxisd(2.9, Vector3(1.0, 2.0, -0.5).normalized()).toRotationMatrix();
  EXPECT_LE(forces(elasticity, Q * mesh.positions).cwiseAbs().maxCoeff(), 1e-12);
  const NodalVectors x = perturbed(3e-3, 6);
  const NodalVectors f = forces(elasticity, x);
  EXPECT_LE((forces(elasticity, Q * x) - Q * f).norm(), 1e-10 * f.norm());
}

TEST_P(CorotationalProperty, TangentFollowsRotationAndLagsByItsThreshold) {
  const TetElasticity elasticity(mesh.positions, mesh.tetrahedra, free, material);
  const auto made = elasticity.makeState();
  Elasticity::State& state = *made;
  const Eigen::MatrixXd K_rest = dense(state.stiffness);
  NodalVectors f(3, mesh.positions.cols());
  const auto turned = [&](double angle) {
    const Matrix3 Q = Eigen::AngleAxisd(angle, Vector3::UnitZ()).toRotationMatrix();
    elasticity.update(Q * mesh.positions, state, f);
    Eigen::MatrixXd Q_all = Eigen::MatrixXd::Zero(K_rest.rows(), K_rest.cols());
    for (Eigen::Index i = 0; i < K_rest.rows(); i += 3) Q_all.block<3, 3>(i, i) = Q;
    return Eigen::MatrixXd(Q_all * K_rest * Q_all.transpose());
  };
  turned(0.5 * TetElasticity::kTangentAngle);
  EXPECT_EQ(dense(state.stiffness), K_rest);
  const Eigen::MatrixXd expected = turned(0.7);
  EXPECT_LE((dense(state.stiffness) - expected).cwiseAbs().maxCoeff(), 1e-12 * K_rest.cwiseAbs().maxCoeff());
}

INSTANTIATE_TEST_SUITE_P(Models, CorotationalProperty, ::testing::Values(ElasticModel::kCorotational));

TEST(Elasticity, RejectsMaterialsOutOfRange) {
  BlockDescription block;
  block.size_m = Vector3(1.0, 1.0, 1.0);
  block.cells = {1, 1, 1};
  const TetMesh mesh = makeBlockMesh(block);
  const std::vector<bool> free(mesh.positions.cols(), false);
  const auto make = [&](double E, double nu) {
    return TetElasticity(mesh.positions, mesh.tetrahedra, free, MaterialDescription{ElasticModel::kLinear, E, nu, 1000.0});
  };
  EXPECT_THROW(make(0.0, 0.3), std::invalid_argument);
  EXPECT_THROW(make(std::nan(""), 0.3), std::invalid_argument);
  EXPECT_THROW(make(1e3, 0.5), std::invalid_argument);
  EXPECT_THROW(make(1e3, std::nan("")), std::invalid_argument);
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
