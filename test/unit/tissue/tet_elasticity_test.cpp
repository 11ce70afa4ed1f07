/// What only the corotational model has: rotations, and a tangent that follows them.
#include "tissue_contact/tissue/tet_elasticity.h"

#include <gtest/gtest.h>

#include <Eigen/LU>
#include <Eigen/SVD>
#include <memory>
#include <random>

#include "tissue_contact/mesh/tet_mesh.h"
#include "validation/elasticity_helpers.h"

namespace tissue_contact {
namespace tet_elasticity_test {

TEST(Corotational, TangentFollowsRotationAndLagsByItsThreshold) {
  const TetMesh mesh = makeBlockMesh({Vector3(0.03, 0.02, 0.02), {2, 2, 2}, {}});
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

TEST(Corotational, ManyTurnsLeaveTheStiffnessThatOneDoes) {
  const TetMesh mesh = makeBlockMesh({Vector3(0.03, 0.02, 0.02), {2, 2, 2}, {}});
  const TetElasticity elasticity(mesh.positions, mesh.tetrahedra, std::vector<bool>(mesh.positions.cols(), false),
                                 MaterialDescription{ElasticModel::kCorotational, 5e3, 0.4, 1000.0});
  const auto state = elasticity.makeState();
  NodalVectors x, f(3, mesh.positions.cols());
  std::mt19937 random(7);
  std::uniform_real_distribution<double> angle(-0.5, 0.5);
  constexpr int kTurns = 1000;
  for (int k = 0; k < kTurns; ++k) {
    const Vector3 axis = Vector3(angle(random), angle(random), 0.3).normalized();
    x = Eigen::AngleAxisd(angle(random), axis).toRotationMatrix() * mesh.positions;
    elasticity.update(x, *state, f);
  }
  const Eigen::MatrixXd fresh = dense(elasticity.makeStateAt(x)->stiffness);
  // What a turn takes out is what the one before put in. The rotation found step by step is that of makeStateAt() to some 1e-9.
  EXPECT_LE((dense(state->stiffness) - fresh).cwiseAbs().maxCoeff(), 1e-8 * fresh.cwiseAbs().maxCoeff());
}

/// A block bent more and more, to `turn` rad at its end, and back: what adapting rotations make of it.
class AdaptedRotations : public testing::Test {
 protected:
  AdaptedRotations() {
    mesh_ = makeBlockMesh({Vector3(0.02, 0.02, 0.06), {2, 2, 6}, {}});
    fixed_.assign(mesh_.positions.cols(), false);
    elasticity_ = std::make_unique<TetElasticity>(mesh_.positions, mesh_.tetrahedra, fixed_,
                                                  MaterialDescription{ElasticModel::kCorotational, 5e3, 0.4, 1000.0});
    adapted_ = elasticity_->makeState();
    adapted_->adapt_rotations = true;
    full_ = elasticity_->makeState();
  }

  NodalVectors bent(double turn) const {
    NodalVectors x = mesh_.positions;
    for (Eigen::Index i = 0; i < x.cols(); ++i) {
      const double angle = turn * x(2, i) / 0.06;
      x.col(i) = Eigen::AngleAxisd(angle, Vector3::UnitY()) * Vector3(1.02 * x(0, i), x(1, i), x(2, i));
    }
    return x;
  }

  NodalVectors forces(double turn, Elasticity::State& state) const {
    NodalVectors f(3, mesh_.positions.cols());
    elasticity_->update(bent(turn), state, f);
    return f;
  }

  /// Largest difference of the forces to those with full rotations, over the largest of these.
  double difference(double turn) {
    const NodalVectors full = forces(turn, *full_);
    return (forces(turn, *adapted_) - full).cwiseAbs().maxCoeff() / full.cwiseAbs().maxCoeff();
  }

  void becomeLinear() {
    for (int k = 0; k <= TetElasticity::kCalmUpdates + 2 * TetElasticity::kBlendUpdates; ++k) forces(0.0, *adapted_);
  }

  TetMesh mesh_;
  std::vector<bool> fixed_;
  std::unique_ptr<TetElasticity> elasticity_;
  std::unique_ptr<Elasticity::State> adapted_, full_;
};

TEST_F(AdaptedRotations, AreLinearAfterACalmAndWithinTheErrorStated) {
  EXPECT_EQ(difference(0.004), 0.0);  // nothing is calm at the start
  becomeLinear();
  for (const double turn : {0.002, 0.005, 0.01}) {
    const double here = difference(turn);
    EXPECT_GT(here, 0.0) << turn;
    // A strain of 2 % is there: its stress turned by theta, and the spurious strain theta^2 / 2 beside it. Twice that for
    // the elements at the end, whose turn is above `turn` where the block is sheared.
    EXPECT_LE(here, 2.0 * (turn + 0.5 * turn * turn / 0.02)) << turn;
  }
}

TEST_F(AdaptedRotations, ComeAndGoWithoutAJumpOfForce) {
  becomeLinear();
  const double scale = forces(0.0, *full_).cwiseAbs().maxCoeff();
  const auto largestStep = [&](double from, double to, Elasticity::State& state) {
    constexpr int kUpdates = 600;
    NodalVectors before = forces(from, state);
    double largest = 0.0;
    for (int k = 1; k <= kUpdates; ++k) {
      const NodalVectors now = forces(from + (to - from) * k / kUpdates, state);
      largest = std::max(largest, (now - before).cwiseAbs().maxCoeff() / scale);
      before = now;
    }
    return largest;
  };
  // What a sudden change of model would be: R = I against the full rotation where the change begins.
  TetElasticity linear(mesh_.positions, mesh_.tetrahedra, fixed_,
                       MaterialDescription{ElasticModel::kLinear, 5e3, 0.4, 1000.0});
  const auto linear_state = linear.makeState();
  NodalVectors f(3, mesh_.positions.cols());
  linear.update(bent(TetElasticity::kTurnOn), *linear_state, f);
  const double jump = (f - forces(TetElasticity::kTurnOn, *full_)).cwiseAbs().maxCoeff() / scale;
  const double plain = largestStep(0.0, 0.06, *full_);
  EXPECT_LE(largestStep(0.0, 0.06, *adapted_), plain + 2.0 * jump / TetElasticity::kBlendUpdates);
  EXPECT_EQ(difference(0.06), 0.0);  // all of the rotation counts by now
  EXPECT_LE(largestStep(0.06, 0.0, *adapted_), plain + 2.0 * jump / TetElasticity::kBlendUpdates);
  becomeLinear();
  EXPECT_GT(difference(0.005), 0.0);  // linear again
}

TEST_F(AdaptedRotations, SuddenTurnsAreFollowed) {
  becomeLinear();
  for (int k = 0; k <= TetElasticity::kBlendUpdates + 1; ++k) forces(1.0, *adapted_);
  EXPECT_LE(difference(1.0), 1e-12);  // rotations were found from another guess
}

/// The forces of the head of tet_elasticity.h, element by element.
NodalVectors plainForces(const TetMesh& mesh, const LameParameters& lame, const NodalVectors& x) {
  NodalVectors forces = NodalVectors::Zero(3, x.cols());
  for (const Tetrahedron& nodes : mesh.tetrahedra) {
    const Matrix3 rest = edgeMatrix(mesh.positions, nodes);
    const Matrix3 F = edgeMatrix(x, nodes) * rest.inverse();
    const Matrix3 R = nearestRotation(F, Quaternion::Identity()).toRotationMatrix();
    const Matrix3 S = R.transpose() * F;
    const Matrix3 strain = 0.5 * (S + S.transpose()) - Matrix3::Identity();
    const Matrix3 P = R * (2.0 * lame.mu * strain + lame.lambda * strain.trace() * Matrix3::Identity());
    const Matrix3 H = -rest.determinant() / 6.0 * P * rest.inverse().transpose();
    for (int i = 0; i < 3; ++i) {
      forces.col(nodes[i + 1]) += H.col(i);
      forces.col(nodes[0]) -= H.col(i);
    }
  }
  return forces;
}

// Newton's last step is of up to 1e-4 rad, so the rotation is off by some 1e-8 rad times the strain; none is while at rest.
TEST_F(AdaptedRotations, ForcesFourElementsAtATimeAreThoseOfEach) {
  const LameParameters lame = lameParameters(MaterialDescription{ElasticModel::kCorotational, 5e3, 0.4, 1000.0});
  for (const double by : {1e-5, 1e-4, 1e-3, 1e-2, 0.3}) {
    const auto state = elasticity_->makeState();
    double turn = 0.0;
    for (int k = 0; k < 8; ++k) {
      turn += by;
      const NodalVectors expected = plainForces(mesh_, lame, bent(turn));
      const double size = expected.cwiseAbs().maxCoeff();
      EXPECT_LE((forces(turn, *state) - expected).cwiseAbs().maxCoeff(), 2e-8 * size) << by;
      EXPECT_LE((forces(turn, *state) - expected).cwiseAbs().maxCoeff(), 1e-12 * size) << by;
    }
  }
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

}  // namespace tet_elasticity_test
}  // namespace tissue_contact
