/// What the neo-Hookean model is for: elements that were turned inside out or pressed flat come back.
#include "tissue/neo_hookean.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <random>
#include <tuple>

#include "tissue/element_patches.h"
#include "tissue/mass_spring.h"
#include "tissue/mean_strain.h"
#include "tissue_contact/mesh/tet_mesh.h"
#include "validation/elasticity_helpers.h"

namespace tissue_contact {
namespace neo_hookean_test {

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
    A.setSum(kStep * kStep, state->stiffness, 0.0, state->stiffness);
    for (Matrix3& block : A.diagonal) block += 1.02 * kMass * Matrix3::Identity();
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

constexpr double kYoung = 5e3;

/// What is averaged over the cells.
struct Variant {
  const char* name;
  NeoHookean::Averages averages;
  bool patches() const { return averages.dilatation || averages.share > 0.0; }
};
constexpr Variant kByElement = {"ByElement", {false, 0.0}};
constexpr Variant kDilatation = {"Dilatation", {true, 0.0}};
constexpr Variant kShare = {"Share", {false, kPatchShapeShare}};
constexpr Variant kBoth = {"Both", {true, kPatchShapeShare}};
const auto kVariants = ::testing::Values(kByElement, kDilatation, kShare, kBoth);

void PrintTo(const Variant& variant, std::ostream* out) { *out << variant.name; }

NeoHookean makeModel(const TetMesh& mesh, double poissons_ratio, const Variant& variant) {
  return {mesh.positions,
          mesh.tetrahedra,
          std::vector<bool>(mesh.positions.cols(), false),
          MaterialDescription{ElasticModel::kNeoHookean, kYoung, poissons_ratio, 1000.0},
          variant.patches() ? patchesByCells(mesh.tetrahedra.size(), kTetrahedraPerCell) : std::vector<int>(),
          variant.averages};
}

class Recovery : public ::testing::TestWithParam<std::tuple<double, Variant>> {};

TEST_P(Recovery, ComesBackFromInsideOutFlatAndAHeap) {
  const TetMesh mesh = smallBlock();
  const NeoHookean elasticity = makeModel(mesh, std::get<0>(GetParam()), std::get<1>(GetParam()));
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
  // A knot presses single elements of patches to below 0.3 of their volume, from where on they resist by themselves.
  const double least = std::get<1>(GetParam()).patches() ? 0.1 : 0.5;
  EXPECT_GT(leastVolume(mesh, heap), least * leastVolume(mesh, mesh.positions));
}

INSTANTIATE_TEST_SUITE_P(PoissonsRatios, Recovery, ::testing::Combine(::testing::Values(0.0, 0.3, 0.45), kVariants));

class ByElementAndByPatch : public ::testing::TestWithParam<Variant> {};
INSTANTIATE_TEST_SUITE_P(NeoHookean, ByElementAndByPatch, kVariants,
                         [](const auto& variant) { return std::string(variant.param.name); });

// The stiffness lags behind small changes only, and what it had before a wild excursion leaves no trace in it.
TEST_P(ByElementAndByPatch, StiffnessIsThatOfTheShapeWhateverCameBefore) {
  const TetMesh mesh = smallBlock();
  const NeoHookean elasticity = makeModel(mesh, 0.45, GetParam());
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

// A mesh that is made beside the steps begins where nodes are (Elasticity::makeStateAt).
TEST_P(ByElementAndByPatch, AStateBegunAtAShapeIsThatOfGoingThere) {
  const TetMesh mesh = smallBlock();
  const NeoHookean elasticity = makeModel(mesh, 0.45, GetParam());
  NodalVectors x = 1.2 * mesh.positions;
  x.row(0) += 0.3 * mesh.positions.row(2);
  const auto went = elasticity.makeState();
  NodalVectors f(3, x.cols());
  elasticity.update(x, *went, f);
  const Eigen::MatrixXd expected = dense(went->stiffness);
  EXPECT_LE((dense(elasticity.makeStateAt(x)->stiffness) - expected).cwiseAbs().maxCoeff(),
            1e-12 * expected.maxCoeff());
}

// P = (mu' (1 - 1/(3 s^2 + 1)) s + (lambda' (s^3 - 1) - 3/4 mu') s^2) I where the block is s times as large; the energy is that
// of psi (neo_hookean.h), with what holds flat elements of patches up: 8 mu' (s^3 - 0.3)^2 and 16 mu' (s^3 - 0.3) s^2.
TEST_P(ByElementAndByPatch, ChangesOfVolumeMeetTheClosedForm) {
  const TetMesh mesh = smallBlock();
  const double nu = 0.45;
  const NeoHookean elasticity = makeModel(mesh, nu, GetParam());
  const double mu = 4.0 / 3.0 * kYoung / (2.0 * (1.0 + nu));
  const double lambda = kYoung * nu / ((1.0 + nu) * (1.0 - 2.0 * nu)) + 5.0 / 8.0 * mu;
  for (const double s : {0.2, 0.8, 1.1, 2.0}) {
    const double J = s * s * s;
    const double flat = GetParam().patches() ? std::min(0.0, J - 0.3) : 0.0;
    const double P =
        mu * (1.0 - 1.0 / (3.0 * s * s + 1.0)) * s + (lambda * (J - 1.0) - 0.75 * mu + 16.0 * mu * flat) * s * s;
    const double psi = 0.5 * mu * (3.0 * s * s - 3.0 - std::log((3.0 * s * s + 1.0) / 4.0)) +
                       0.5 * lambda * (J - 1.0) * (J - 1.0) - 0.75 * mu * (J - 1.0) + 8.0 * mu * flat * flat;
    constexpr double kVolume = 8e-6;
    EXPECT_NEAR(elasticity.energy(s * mesh.positions), kVolume * psi, 1e-12 * kVolume * kYoung * (1.0 + J * J)) << s;
    // Virial: sum of f . X = -V P : I.
    const NodalVectors f = elasticForces(elasticity, s * mesh.positions);
    EXPECT_NEAR(f.cwiseProduct(mesh.positions).sum(), -3.0 * kVolume * P, 1e-11 * kVolume * kYoung * (1.0 + J * J))
        << s;
  }
}

// Patch test: where all elements are strained alike, averaging changes nothing, however large the strain, while none is flat.
TEST_P(ByElementAndByPatch, UniformStrainGivesTheForcesOfElements) {
  const TetMesh mesh = smallBlock();
  Matrix3 F;
  F << 1.6, 0.1, -0.4, 0.3, 0.5, 0.1, 0.0, 0.3, 1.2;
  const NodalVectors plain = elasticForces(makeModel(mesh, 0.45, kByElement), F * mesh.positions);
  const NodalVectors averaged = elasticForces(makeModel(mesh, 0.45, GetParam()), F * mesh.positions);
  EXPECT_LE((averaged - plain).norm(), 1e-12 * plain.norm());
}

// At small strain the laws are one, and so is what patches do to them: no locking in bending (mean_strain_test.cpp).
TEST(NeoHookeanPatches, StiffnessAtRestIsThatOfLinearPatches) {
  const TetMesh mesh = smallBlock();
  MaterialDescription material{ElasticModel::kLinear, kYoung, 0.49, 1000.0};
  for (const Variant& variant : {kDilatation, kBoth}) {
    const MeanStrain linear(mesh.positions, mesh.tetrahedra, std::vector<bool>(mesh.positions.cols(), false), material,
                            patchesByCells(mesh.tetrahedra.size(), kTetrahedraPerCell), variant.averages.share);
    const Eigen::MatrixXd expected = dense(linear.makeState()->stiffness);
    const Eigen::MatrixXd got = dense(makeModel(mesh, 0.49, variant).makeState()->stiffness);
    EXPECT_LE((got - expected).cwiseAbs().maxCoeff(), 1e-12 * expected.maxCoeff()) << variant.name;
  }
}

// Volume may move between the elements of a patch, and not out of it: nu = 0.4999, so that any change of the patch's volume would
// cost ten thousand times as much.
TEST(NeoHookeanPatches, ElementsMayChangeWhatTheirPatchKeeps) {
  const TetMesh mesh = smallBlock();
  NodalVectors x = mesh.positions;
  for (Eigen::Index i = 0; i < x.cols(); ++i) {
    if (x.col(i).norm() < 1e-9 + 0.01 && x(2, i) == 0.01) x(2, i) += 0.002;  // the node inside the block
  }
  EXPECT_LT(makeModel(mesh, 0.4999, kDilatation).energy(x), 0.5 * makeModel(mesh, 0.4999, kByElement).energy(x));
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

}  // namespace neo_hookean_test
}  // namespace tissue_contact
