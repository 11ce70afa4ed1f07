/// What the neo-Hookean model is for: elements that were turned inside out or pressed flat come back.
#include "tissue/neo_hookean.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <random>

#include "tissue/mass_spring.h"
#include "tissue_contact/mesh/tet_mesh.h"
#include "validation/elasticity_helpers.h"

namespace tissue_contact {
namespace {

TetMesh smallBlock() { return makeBlockMesh({Vector3(0.02, 0.02, 0.02), {2, 2, 2}, {}}); }

/// Free motion from rest, damped at 20/s, by implicit Euler steps of 1 ms. 0.3 g is what a node of such a block weighs.
void move(const Elasticity& elasticity, int steps, NodalVectors& x) {
  constexpr double kMass = 3e-4;
  constexpr double kStep = 1e-3;
  const auto state = elasticity.makeState();
  NodalVectors f(3, x.cols());
  NodalVectors v = NodalVectors::Zero(3, x.cols());
  for (int step = 0; step < steps; ++step) {
    elasticity.update(x, *state, f);
    BlockMatrix A = state->stiffness;
    for (Matrix3& block : A.values) block *= kStep * kStep;
    for (Matrix3& block : A.diagonal) block = kStep * kStep * block + 1.02 * kMass * Matrix3::Identity();
    NodalVectors next = NodalVectors::Zero(3, x.cols());
    solveStatic(A, std::vector<bool>(static_cast<std::size_t>(x.size()), false), kMass * v + kStep * f, next);
    v = next;
    x += kStep * v;
  }
}

double leastVolume(const TetMesh& mesh, const NodalVectors& x) {
  double least = std::numeric_limits<double>::infinity();
  for (const Tetrahedron& tet : mesh.tetrahedra) least = std::min(least, signedVolume(x, tet));
  return least;
}

class Recovery : public ::testing::TestWithParam<double> {};

TEST_P(Recovery, ComesBackFromInsideOutFlatAndAHeap) {
  const TetMesh mesh = smallBlock();
  const NeoHookean elasticity(mesh.positions, mesh.tetrahedra, std::vector<bool>(mesh.positions.cols(), false),
                              MaterialDescription{ElasticModel::kNeoHookean, 5e3, GetParam(), 1000.0});
  NodalVectors shaken = mesh.positions;  // by 7 mm, cells being 10 mm
  NodalVectors heap = mesh.positions;
  std::mt19937 random(11);
  std::uniform_real_distribution<double> uniform(-0.01, 0.01);
  for (Eigen::Index i = 0; i < heap.size(); ++i) {
    heap.data()[i] = uniform(random);
    shaken.data()[i] += 0.7 * uniform(random);
  }
  const std::vector<NodalVectors> starts = {Vector3(1.0, 1.0, -1.0).asDiagonal() * mesh.positions,
                                            Vector3(1.0, 0.0, 1.0).asDiagonal() * mesh.positions,
                                            Vector3(1e-3, 1e-3, 1e-3).asDiagonal() * mesh.positions, shaken};
  for (NodalVectors x : starts) {
    const double energy = elasticity.energy(x);
    ASSERT_LT(leastVolume(mesh, x), 1e-12);
    move(elasticity, 1500, x);
    EXPECT_LT(elasticity.energy(x), 1e-12 * energy);
    EXPECT_NEAR(leastVolume(mesh, x), leastVolume(mesh, mesh.positions), 1e-12);
  }
  // A mesh can be knotted without any element being inverted; no energy of its elements undoes that.
  ASSERT_LT(leastVolume(mesh, heap), 0.0);
  move(elasticity, 1500, heap);
  EXPECT_GT(leastVolume(mesh, heap), 0.5 * leastVolume(mesh, mesh.positions));
}

INSTANTIATE_TEST_SUITE_P(PoissonsRatios, Recovery, ::testing::Values(0.0, 0.3, 0.45));

// The stiffness lags behind small changes only, and what it had before a wild excursion leaves no trace in it.
TEST(NeoHookean, StiffnessIsThatOfTheShapeWhateverCameBefore) {
  const TetMesh mesh = smallBlock();
  const NeoHookean elasticity(mesh.positions, mesh.tetrahedra, std::vector<bool>(mesh.positions.cols(), false),
                              MaterialDescription{ElasticModel::kNeoHookean, 5e3, 0.45, 1000.0});
  const auto state = elasticity.makeState();
  const Eigen::MatrixXd K_rest = dense(state->stiffness);
  NodalVectors f(3, mesh.positions.cols());
  elasticity.update(1e4 * mesh.positions, *state, f);
  EXPECT_GT(dense(state->stiffness).maxCoeff(), 1e10 * K_rest.maxCoeff());
  elasticity.update(mesh.positions, *state, f);
  EXPECT_LE((dense(state->stiffness) - K_rest).cwiseAbs().maxCoeff(), 1e-12 * K_rest.maxCoeff());
  elasticity.update(1.001 * mesh.positions, *state, f);  // F changes by 0.0017
  EXPECT_LE((dense(state->stiffness) - K_rest).cwiseAbs().maxCoeff(), 1e-12 * K_rest.maxCoeff());
  elasticity.update(1.01 * mesh.positions, *state, f);
  EXPECT_GT((dense(state->stiffness) - K_rest).cwiseAbs().maxCoeff(), 1e-3 * K_rest.maxCoeff());
}

TEST(MassSpring, NodesInOnePlaceGiveNoNan) {
  const TetMesh mesh = smallBlock();
  const MassSpring elasticity(mesh.positions, mesh.tetrahedra, std::vector<bool>(mesh.positions.cols(), false),
                              MaterialDescription{ElasticModel::kMassSpring, 5e3, 0.25, 1000.0});
  const auto state = elasticity.makeState();
  NodalVectors f(3, mesh.positions.cols());
  elasticity.update(NodalVectors::Zero(3, mesh.positions.cols()), *state, f);
  EXPECT_TRUE(f.allFinite());
  EXPECT_TRUE(dense(state->stiffness).allFinite());
}

}  // namespace
}  // namespace tissue_contact
