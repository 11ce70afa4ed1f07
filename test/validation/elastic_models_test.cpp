/// Closed forms of the models beyond linear elasticity of one material: neo-Hookean bars at finite strain, mass-spring
/// volumes under uniform strain, layered bars, Kelvin-Voigt creep.
#include <gtest/gtest.h>

#include <cmath>

#include "validation/elasticity_helpers.h"
#include "tissue_contact/tissue/make_elasticity.h"
#include "tissue_contact/tissue/tet_mesh.h"
#include "tissue_contact/tissue/tissue.h"

namespace tissue_contact {
namespace {

constexpr double kYoung = 1e4;

TissueDescription bar(ElasticModel model, double nu, const Vector3& size, const std::array<int, 3>& cells) {
  TissueDescription description;
  description.name = "bar";
  BlockDescription block;
  block.size_m = size;
  block.cells = cells;
  description.geometry = block;
  description.material = {model, kYoung, nu, 1000.0};
  return description;
}

/// Coordinates held so that a bar can be pulled along z and contract freely: z at both ends, x and y in the planes of
/// symmetry (which must hold nodes).
std::vector<bool> pulledBar(const NodalVectors& rest, double length) {
  std::vector<bool> prescribed;
  for (Eigen::Index i = 0; i < rest.cols(); ++i) {
    prescribed.push_back(rest(0, i) == 0.0);
    prescribed.push_back(rest(1, i) == 0.0);
    prescribed.push_back(rest(2, i) == 0.0 || rest(2, i) == length);
  }
  return prescribed;
}

/// Tension of a bar stretched to `stretch`, N.
double pull(const Tissue& tissue, double length, double stretch, double* lateral = nullptr) {
  const NodalVectors& rest = tissue.restPositions();
  const double guess = 1.0 / std::sqrt(stretch);  // of the lateral stretch: near enough for Newton
  NodalVectors x = Vector3(guess, guess, stretch).asDiagonal() * rest;
  const double residual =
      solveEquilibrium(tissue.elasticity(), pulledBar(rest, length), NodalVectors::Zero(3, rest.cols()), 60, x);
  const NodalVectors f = elasticForces(tissue.elasticity(), x);
  double tension = 0.0;
  for (Eigen::Index i = 0; i < rest.cols(); ++i) {
    if (rest(2, i) == length) tension -= f(2, i);
  }
  EXPECT_LE(residual, 1e-9 * std::abs(tension));
  if (lateral != nullptr) *lateral = x.row(0).maxCoeff() / rest.row(0).maxCoeff();
  return tension;
}

/// Lateral stretch and tension per area of psi under uniaxial stretch s: two equations, P_lateral = 0 and P_axial.
void uniaxial(double nu, double s, double& lateral, double& stress) {
  const double mu_lame = kYoung / (2.0 * (1.0 + nu));
  const double lambda_lame = kYoung * nu / ((1.0 + nu) * (1.0 - 2.0 * nu));
  const double mu = 4.0 / 3.0 * mu_lame;
  const double lambda = lambda_lame + 5.0 / 6.0 * mu_lame;
  const double alpha = 1.0 + 0.75 * mu / lambda;
  const auto P = [&](double axis, double cofactor) {
    const double I = 2.0 * lateral * lateral + s * s;
    return mu * (1.0 - 1.0 / (I + 1.0)) * axis + lambda * (lateral * lateral * s - alpha) * cofactor;
  };
  double low = 0.1;  // P_lateral / lateral grows with the lateral stretch
  double high = 5.0;
  for (int i = 0; i < 200; ++i) {
    lateral = 0.5 * (low + high);
    (P(lateral, lateral * s) > 0.0 ? high : low) = lateral;
  }
  stress = P(s, lateral * lateral);
}

// A uniform state: linear tetrahedra hold it exactly, so only Newton's residual is left.
TEST(NeoHookean, BarFollowsTheClosedFormAtFiniteStrain) {
  for (const double nu : {0.0, 0.3, 0.45, 0.49}) {
    const Tissue tissue(bar(ElasticModel::kNeoHookean, nu, {0.02, 0.02, 0.04}, {2, 2, 3}), Pose::Identity());
    for (const double stretch : {0.6, 0.9, 1.2, 1.8}) {
      double expected_lateral = 1.0;
      double expected_stress = 0.0;
      uniaxial(nu, stretch, expected_lateral, expected_stress);
      double lateral = 0.0;
      EXPECT_NEAR(pull(tissue, 0.04, stretch, &lateral) / 4e-4, expected_stress, 1e-8 * std::abs(expected_stress))
          << "nu " << nu << ", stretch " << stretch;
      EXPECT_NEAR(lateral, expected_lateral, 1e-8);
    }
  }
}

TEST(NeoHookean, IsLinearElasticityAtSmallStrain) {
  for (const double nu : {-0.3, 0.0, 0.3, 0.49, 0.499}) {
    const Tissue hyperelastic(bar(ElasticModel::kNeoHookean, nu, {0.02, 0.03, 0.04}, {2, 3, 3}), Pose::Identity());
    const Tissue linear(bar(ElasticModel::kLinear, nu, {0.02, 0.03, 0.04}, {2, 3, 3}), Pose::Identity());
    const Eigen::MatrixXd K = dense(linear.elasticity().makeState()->stiffness);
    const Eigen::MatrixXd difference = dense(hyperelastic.elasticity().makeState()->stiffness) - K;
    EXPECT_LE(difference.cwiseAbs().maxCoeff(), 1e-12 * K.cwiseAbs().maxCoeff()) << nu;
    Matrix3 strain;
    strain << 1.0, 0.3, -0.2, 0.3, -0.5, 0.1, -0.2, 0.1, 0.4;
    for (const double size : {1e-4, 1e-5}) {  // the difference is of second order
      const NodalVectors x = (Matrix3::Identity() + size * strain) * linear.restPositions();
      const NodalVectors f = elasticForces(linear.elasticity(), x);
      EXPECT_LE((elasticForces(hyperelastic.elasticity(), x) - f).norm(), 20.0 * size * f.norm()) << nu;
    }
  }
}

// Under uniform strain the springs of a mesh hold the energy of an isotropic body of modulus E and Poisson's ratio 1/4.
TEST(MassSpring, IsIsotropicWithTheGivenModulusUnderUniformStrain) {
  const Vector3 size(0.03, 0.03, 0.03);
  const Tissue even(bar(ElasticModel::kMassSpring, 0.25, size, {3, 3, 3}), Pose::Identity());
  TissueDescription graded_description = bar(ElasticModel::kMassSpring, 0.25, size, {4, 4, 4});
  for (AxisGrading& axis : std::get<BlockDescription>(graded_description.geometry).grading) axis.growth = 1.2;
  const Tissue graded(graded_description, Pose::Identity());
  Matrix3 strain;
  strain << 1.0, 0.3, -0.2, 0.3, -0.5, 0.1, -0.2, 0.1, 0.4;
  for (const Tissue* tissue : {&even, &graded}) {
    const Eigen::MatrixXd K = dense(tissue->elasticity().makeState()->stiffness);
    for (const Matrix3& e : {strain, Matrix3(Matrix3::Identity()), Matrix3(Vector3(0.0, 0.0, 1.0).asDiagonal()),
                             Matrix3(Vector3(1.0, -1.0, 0.0).asDiagonal())}) {
      const NodalVectors u = e * tissue->restPositions();
      const Eigen::Map<const VectorX> all(u.data(), u.size());
      const double lame = 0.4 * kYoung;
      const double expected = 2.7e-5 * (lame * e.squaredNorm() + 0.5 * lame * e.trace() * e.trace());
      EXPECT_NEAR(0.5 * all.dot(K * all), expected, 1e-9 * expected);
    }
  }
}

// A real bar's surface springs are not in balance with that: the error is of the order of a cell over the width.
TEST(MassSpring, BarHasTheGivenModulusUpToItsSurface) {
  const auto ratio = [](int n) {
    const Tissue tissue(bar(ElasticModel::kMassSpring, 0.25, {0.02, 0.02, 0.04}, {n, n, 2 * n}), Pose::Identity());
    return pull(tissue, 0.04, 1.0001) / (1e-4 * kYoung * 4e-4);
  };
  const double coarse = ratio(2);
  const double fine = ratio(6);
  RecordProperty("ratio_2_6", std::to_string(coarse) + " " + std::to_string(fine));
  EXPECT_NEAR(coarse, 1.0, 0.05);
  EXPECT_NEAR(fine, 1.0, 0.02);
  EXPECT_LT(std::abs(fine - 1.0), std::abs(coarse - 1.0));
}

TissueDescription layeredBar(ElasticModel model) {
  TissueDescription description = bar(model, 0.0, {0.02, 0.02, 0.05}, {2, 2, 5});
  TissueRegion region;
  region.name = "soft";
  region.where = {BoxRegion{Vector3(-1.0, -1.0, 0.02), Vector3(1.0, 1.0, 0.05)}};
  region.material = description.material;
  region.material.youngs_modulus_pa = 0.2 * kYoung;
  description.regions = {region};
  return description;
}

/// Consistent nodal loads of a total force along z over the face at z = length.
NodalVectors endLoads(const Tissue& tissue, double length, double force) {
  NodalVectors loads = NodalVectors::Zero(3, tissue.nodeCount());
  double area = 0.0;
  for (const Triangle& t : tissue.surface()) {
    const auto x = [&](std::size_t i) { return Vector3(tissue.restPositions().col(t[i])); };
    if (x(0).z() != length || x(1).z() != length || x(2).z() != length) continue;
    const double third = (x(1) - x(0)).cross(x(2) - x(0)).norm() / 6.0;
    for (const int node : t) loads(2, node) += third;
    area += 3.0 * third;
  }
  return loads * (force / area);
}

// Two springs in series: F L1 / (E1 A) + F L2 / (E2 A). With nu = 0 there is no lateral strain to disturb it.
TEST(LayeredBar, IsSpringsInSeries) {
  for (const ElasticModel model : {ElasticModel::kLinear, ElasticModel::kCorotational, ElasticModel::kNeoHookean}) {
    const Tissue tissue(layeredBar(model), Pose::Identity());
    const double F = 1e-3;
    std::vector<bool> prescribed;
    for (int i = 0; i < tissue.nodeCount(); ++i)
      prescribed.insert(prescribed.end(), 3, tissue.restPositions()(2, i) == 0.0);
    NodalVectors u = NodalVectors::Zero(3, tissue.nodeCount());
    solveStatic(tissue.elasticity().makeState()->stiffness, prescribed, endLoads(tissue, 0.05, F), u);
    for (int i = 0; i < tissue.nodeCount(); ++i) {
      const double z = tissue.restPositions()(2, i);
      const double expected = F / (kYoung * 4e-4) * (std::min(z, 0.02) + 5.0 * std::max(0.0, z - 0.02));
      ASSERT_NEAR(u(2, i), expected, 1e-10 * F / (kYoung * 4e-4) * 0.17);
    }
  }
}

/// End displacement after `time` of a bar under a constant end load, by implicit Euler steps of the room's matrices:
/// (M + dt D + dt^2 K) v = M v0 + dt f(x0) + dt load, D = stiffness_s K or State::damping.
double creep(const Tissue& tissue, double length, double force, double time, int steps) {
  const double dt = time / steps;
  const NodalVectors loads = endLoads(tissue, length, force);
  std::vector<bool> prescribed;
  for (int i = 0; i < tissue.nodeCount(); ++i)
    prescribed.insert(prescribed.end(), 3, tissue.restPositions()(2, i) == 0.0);
  const auto state = tissue.elasticity().makeState();
  NodalVectors x = tissue.restPositions();
  NodalVectors v = NodalVectors::Zero(3, x.cols());
  NodalVectors f(3, x.cols());
  for (int step = 0; step < steps; ++step) {
    tissue.elasticity().update(x, *state, f);
    BlockMatrix A = state->stiffness;
    for (std::size_t i = 0; i < A.values.size(); ++i) {
      A.values[i] *= dt * (dt + tissue.damping().stiffness_s);
      if (state->damping.rows() > 0) A.values[i] += dt * state->damping.values[i];
    }
    for (std::size_t i = 0; i < A.diagonal.size(); ++i) {
      A.diagonal[i] *= dt * (dt + tissue.damping().stiffness_s);
      if (state->damping.rows() > 0) A.diagonal[i] += dt * state->damping.diagonal[i];
      A.diagonal[i].diagonal().array() += tissue.nodeMasses()[static_cast<Eigen::Index>(i)];
    }
    const NodalVectors b = v * tissue.nodeMasses().asDiagonal() + dt * (f + loads);
    NodalVectors next = NodalVectors::Zero(3, x.cols());
    solveStatic(A, prescribed, b, next);
    v = next;
    x += dt * v;
  }
  return (x.row(2).maxCoeff() - length);
}

// u(t) = F L / (E A) (1 - exp(-t / tau)), tau = stiffness_s: the mass is so small that waves cross in 1e-6 tau.
TEST(KelvinVoigt, CreepsWithItsTimeConstant) {
  TissueDescription description = bar(ElasticModel::kLinear, 0.0, {0.02, 0.02, 0.05}, {2, 2, 5});
  description.material.density_kg_per_m3 = 1e-6;
  description.damping.stiffness_s = 0.2;
  const Tissue tissue(description, Pose::Identity());
  EXPECT_EQ(tissue.damping().stiffness_s, 0.2);
  const double F = 1e-3;
  const double expected = F * 0.05 / (kYoung * 4e-4) * (1.0 - std::exp(-0.15 / 0.2));
  double before = 0.0;
  for (const int steps : {20, 40, 80}) {
    const double error = creep(tissue, 0.05, F, 0.15, steps) / expected - 1.0;
    EXPECT_LT(std::abs(error), 0.5 / steps);
    // Implicit Euler is of first order.
    if (before != 0.0) {
      EXPECT_NEAR(before / error, 2.0, 0.1);
    }
    before = error;
  }
}

TEST(KelvinVoigt, LayersCreepEachWithItsOwnTimeConstant) {
  TissueDescription description = layeredBar(ElasticModel::kCorotational);
  description.material.density_kg_per_m3 = description.regions[0].material.density_kg_per_m3 = 1e-6;
  description.damping.stiffness_s = 0.1;
  description.regions[0].damping_stiffness_s = 0.4;
  const Tissue tissue(description, Pose::Identity());
  EXPECT_EQ(tissue.damping().stiffness_s, 0.0);
  const double F = 1e-4;
  const double expected =
      F / (kYoung * 4e-4) * (0.02 * (1.0 - std::exp(-0.15 / 0.1)) + 5.0 * 0.03 * (1.0 - std::exp(-0.15 / 0.4)));
  const double coarse = creep(tissue, 0.05, F, 0.15, 40) / expected - 1.0;
  const double fine = creep(tissue, 0.05, F, 0.15, 80) / expected - 1.0;
  EXPECT_LT(std::abs(fine), 0.005);
  EXPECT_NEAR(coarse / fine, 2.0, 0.1);
}

}  // namespace
}  // namespace tissue_contact
