/// Closed forms of stress relaxation: a held shear, a swinging one, a turned body, a creeping bar.
#include <gtest/gtest.h>

#include <cmath>
#include <complex>

#include "tissue_contact/mesh/tet_mesh.h"
#include "tissue_contact/simulation/scene.h"
#include "tissue_contact/simulation/simulator.h"
#include "tissue_contact/tissue/make_elasticity.h"
#include "tissue_contact/tissue/tissue.h"

namespace tissue_contact {
namespace viscoelastic_test {

constexpr double kYoung = 9e3;
constexpr double kPoisson = 0.45;
const double kShear = kYoung / (2.0 * (1.0 + kPoisson));  // relaxed
const std::vector<PronyTerm> kTerms = {{0.5, 0.05}, {1.5, 2.0}};

double relaxationModulus(double t) {
  double modulus = 1.0;
  for (const PronyTerm& term : kTerms) modulus += term.modulus_ratio * std::exp(-t / term.time_s);
  return kShear * modulus;
}

/// A block of side 20 mm under uniform strain, and the force on its upper face.
class Cube {
 public:
  explicit Cube(ElasticModel model) {
    mesh_ = makeBlockMesh({Vector3(0.02, 0.02, 0.02), {2, 2, 2}, {}});
    MaterialDescription material{model, kYoung, kPoisson, 1000.0, -1.0, Dilatation::kElement};
    material.prony_series = kTerms;
    elasticity_ = makeVolumeElasticity(mesh_.positions, mesh_.tetrahedra,
                                       std::vector<bool>(mesh_.positions.cols(), false), material, {});
    state_ = elasticity_->makeState();
    forces_.resize(3, mesh_.positions.cols());
  }

  /// The mean traction on the upper face (Pa) `elapsed_s` after the last call, as a step of no length sees it.
  Vector3 traction(const Matrix3& F, double elapsed_s) {
    state_->elapsed_s = elapsed_s;
    elasticity_->update(F * mesh_.positions, *state_, forces_);
    Vector3 sum = Vector3::Zero();
    const double top = mesh_.positions.row(2).maxCoeff();
    for (Eigen::Index i = 0; i < mesh_.positions.cols(); ++i) {
      if (mesh_.positions(2, i) == top) sum -= forces_.col(i);
    }
    return sum / 4e-4;
  }
  /// As traction(), with the decay over a step to come.
  Vector3 tractionAhead(const Matrix3& F, double step_s) {
    state_->step_s = step_s;
    return traction(F, 0.0);
  }

 private:
  TetMesh mesh_;
  std::unique_ptr<const Elasticity> elasticity_;
  std::unique_ptr<Elasticity::State> state_;
  NodalVectors forces_;
};

Matrix3 shear(double angle) {
  Matrix3 F = Matrix3::Identity();
  F(0, 2) = angle;
  return F;
}

class ViscoelasticModels : public ::testing::TestWithParam<ElasticModel> {};
INSTANTIATE_TEST_SUITE_P(Models, ViscoelasticModels,
                         ::testing::Values(ElasticModel::kLinear, ElasticModel::kCorotational,
                                           ElasticModel::kNeoHookean));

TEST_P(ViscoelasticModels, AHeldShearRelaxesAsItsSeries) {
  Cube cube(GetParam());
  const double angle = 1e-6;  // small: the models differ by its square
  EXPECT_NEAR(cube.traction(shear(angle), 0.0).x() / (angle * kShear), 3.0, 1e-5);
  double t = 0.0;
  for (const double dt : {0.001, 0.02, 0.3, 1.7, 40.0}) {  // whatever the steps
    t += dt;
    EXPECT_NEAR(cube.traction(shear(angle), dt).x() / (angle * relaxationModulus(t)), 1.0, 1e-5) << t;
  }
}

// A ramp is what a step takes exactly, in one step or in many.
TEST_P(ViscoelasticModels, ARampGivesTheIntegralOfTheModulus) {
  const double rate = 1e-6;
  const double end = 0.4;
  double expected = kShear * rate * end;
  for (const PronyTerm& term : kTerms) {
    expected += kShear * rate * term.modulus_ratio * term.time_s * (1.0 - std::exp(-end / term.time_s));
  }
  for (const int steps : {1, 7, 100}) {
    Cube cube(GetParam());
    cube.traction(Matrix3::Identity(), 0.0);
    double last = 0.0;
    for (int i = 1; i <= steps; ++i) last = cube.traction(shear(rate * end * i / steps), end / steps).x();
    EXPECT_NEAR(last / expected, 1.0, 1e-5) << steps;
  }
}

// G(w) = G (1 + sum g i w tau / (1 + i w tau)): storage and loss modulus, after the start has died away.
TEST_P(ViscoelasticModels, ASwingingShearHasTheComplexModulus) {
  const double amplitude = 1e-6;
  for (const double omega : {0.7, 20.0}) {
    std::complex<double> expected = 1.0;
    for (const PronyTerm& term : kTerms) {
      const std::complex<double> turned(0.0, omega * term.time_s);
      expected += term.modulus_ratio * turned / (1.0 + turned);
    }
    Cube cube(GetParam());
    const int per_cycle = 400;
    const int cycles = 2 + static_cast<int>(20.0 * omega);  // 60 longest times
    const double dt = 2.0 * M_PI / omega / per_cycle;
    cube.traction(Matrix3::Identity(), 0.0);
    std::complex<double> got;
    for (int i = 1; i <= cycles * per_cycle; ++i) {
      const double phase = 2.0 * M_PI * i / per_cycle;
      const double stress = cube.traction(shear(amplitude * std::sin(phase)), dt).x() / (amplitude * kShear);
      if (i > (cycles - 1) * per_cycle)
        got += 2.0 / per_cycle * stress * std::complex<double>(std::sin(phase), std::cos(phase));
    }
    EXPECT_NEAR(got.real(), expected.real(), 1e-4 * expected.real()) << omega;
    EXPECT_NEAR(got.imag(), expected.imag(), 2e-4 * expected.imag()) << omega;
  }
}

TEST_P(ViscoelasticModels, ChangesOfVolumeDoNotRelax) {
  Cube cube(GetParam());
  const Matrix3 F = (1.0 + 1e-6) * Matrix3::Identity();
  const double before = cube.traction(F, 0.0).z();
  EXPECT_NEAR(before, 3e-6 * kYoung / (3.0 * (1.0 - 2.0 * kPoisson)), 1e-5 * before);
  EXPECT_NEAR(cube.traction(F, 0.3).z(), before, 1e-9 * before);
}

// What a step takes as its force is the stress at its end if nothing moves.
TEST_P(ViscoelasticModels, AStepSeesTheStressAtItsEnd) {
  Cube cube(GetParam());
  const double angle = 1e-6;
  EXPECT_NEAR(cube.tractionAhead(shear(angle), 0.1).x() / (angle * relaxationModulus(0.1)), 1.0, 1e-5);
}

// Objective: what the terms hold turns with the body.
TEST(Viscoelastic, HeldStressTurnsWithTheBody) {
  for (const ElasticModel model : {ElasticModel::kCorotational, ElasticModel::kNeoHookean}) {
    Cube cube(model);
    const Matrix3 F = shear(0.1);
    const Vector3 before = cube.traction(F, 0.0);
    const Matrix3 turn = Eigen::AngleAxisd(2.0, Vector3(1.0, 2.0, -1.0).normalized()).toRotationMatrix();
    EXPECT_LT((cube.traction(turn * F, 0.0) - turn * before).norm(), 1e-9 * before.norm());
  }
}

TEST(Viscoelastic, OtherModelsAreRefused) {
  TissueDescription description;
  description.name = "pad";
  description.geometry = BlockDescription{Vector3(0.02, 0.02, 0.02), {1, 1, 1}, {}};
  description.material = {ElasticModel::kMassSpring, kYoung, 0.25, 1000.0, -1.0, Dilatation::kAuto};
  description.material.prony_series = kTerms;
  EXPECT_THROW(checkTissue(description), std::invalid_argument);
  description.material.model = ElasticModel::kCorotational;
  EXPECT_NO_THROW(checkTissue(description));
  description.material.prony_series[1].time_s = 0.0;
  EXPECT_THROW(checkTissue(description), std::invalid_argument);
}

}  // namespace viscoelastic_test
}  // namespace tissue_contact
