/// The forces that the kernels compute for four elements at a time against the formulas of the models' heads, element by element and in
/// plain loops: 15 elements, so that the last batch is filled up, of two materials.
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "tissue/element_patches.h"
#include "tissue_contact/mesh/tet_mesh.h"
#include "tissue_contact/tissue/make_elasticity.h"
#include "tissue_contact/tissue/tet_elasticity.h"

namespace tissue_contact {
namespace {

struct Case {
  const char* name;
  ElasticModel model;
  Dilatation dilatation;
};

void PrintTo(const Case& value, std::ostream* out) { *out << value.name; }

Matrix3 symmetric(const Matrix3& A) { return 0.5 * (A + A.transpose()); }
Matrix3 deviator(const Matrix3& A) { return A - A.trace() / 3.0 * Matrix3::Identity(); }

/// det F F^-T, of any F.
Matrix3 cofactors(const Matrix3& F) {
  Matrix3 C;
  for (int i = 0; i < 3; ++i) C.col(i) = F.col((i + 1) % 3).cross(F.col((i + 2) % 3));
  return C;
}

class PlainForces : public testing::TestWithParam<Case> {
 protected:
  PlainForces() {
    MaterialDescription soft{GetParam().model, 5e3, 0.4, 1000.0};
    soft.dilatation = GetParam().dilatation;
    materials_ = soft;
    materials_.materials.push_back(soft);
    materials_.materials[1].youngs_modulus_pa = 20e3;
    materials_.materials[1].poissons_ratio = 0.2;
    for (std::size_t e = 0; e < mesh_.tetrahedra.size(); ++e) materials_.of_element.push_back(e % 3 == 0 ? 1 : 0);
    patch_of_ = patchesByCells(mesh_.tetrahedra.size(), kTetrahedraPerCell);
  }

  std::unique_ptr<const Elasticity> makeElasticity() const {
    return makeVolumeElasticity(mesh_.positions, mesh_.tetrahedra, std::vector<bool>(mesh_.positions.cols(), false),
                                materials_, patch_of_);
  }

  bool averages() const { return GetParam().dilatation == Dilatation::kPatch; }
  bool turns() const { return GetParam().model != ElasticModel::kLinear; }

  /// Turned by .4 rad, flattened to `height` and shaken by a tenth of a cell.
  NodalVectors deformed(double height) const {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> uniform(-1e-3, 1e-3);
    NodalVectors x = mesh_.positions;
    x.row(2) *= height;
    for (Eigen::Index i = 0; i < x.size(); ++i) x.data()[i] += uniform(random);
    return Eigen::AngleAxisd(0.4, Vector3(1, 2, 3).normalized()).toRotationMatrix() * x;
  }

  Matrix3 gradient(const NodalVectors& x, std::size_t e) const {
    return edgeMatrix(x, mesh_.tetrahedra[e]) * edgeMatrix(mesh_.positions, mesh_.tetrahedra[e]).inverse();
  }
  double volume(std::size_t e) const { return edgeMatrix(mesh_.positions, mesh_.tetrahedra[e]).determinant() / 6.0; }
  Matrix3 rotation(const Matrix3& F) const {
    return turns() ? nearestRotation(F, Quaternion::Identity()).toRotationMatrix() : Matrix3(Matrix3::Identity());
  }
  Matrix3 strain(const Matrix3& F) const { return symmetric(rotation(F).transpose() * F) - Matrix3::Identity(); }

  /// kappa times the mean of what a patch's elements change their volume by, Pa, for each element; zero without patches.
  std::vector<double> patchPressures(const NodalVectors& x) const {
    std::vector<double> V(mesh_.tetrahedra.size()), bulk(V), change(V), pressures(V);
    for (std::size_t e = 0; e < V.size() && averages(); ++e) {
      const LameParameters lame = lameParameters(materials_.of(e));
      const Matrix3 F = gradient(x, e);
      V[patch_of_[e]] += volume(e);
      bulk[patch_of_[e]] += volume(e) * (lame.lambda + 2.0 / 3.0 * lame.mu);
      change[patch_of_[e]] +=
          volume(e) * (GetParam().model == ElasticModel::kNeoHookean ? F.determinant() - 1.0 : strain(F).trace());
    }
    for (std::size_t e = 0; e < V.size() && averages(); ++e) {
      const int p = patch_of_[e];
      pressures[e] = bulk[p] / V[p] * change[p] / V[p];
    }
    return pressures;
  }

  /// First Piola-Kirchhoff stress, Pa. @param pressure of the element's patch, Pa.
  Matrix3 stress(const LameParameters& lame, const Matrix3& F, double pressure) const {
    if (GetParam().model == ElasticModel::kNeoHookean) {
      const double mu = 4.0 / 3.0 * lame.mu;
      const double lambda = averages() ? mu / 8.0 : lame.lambda + 5.0 / 6.0 * lame.mu;
      const double J = F.determinant();
      const double flat = averages() ? 8.0 * mu * std::min(0.0, J - 0.5) : 0.0;
      return mu * (1.0 - 1.0 / (F.squaredNorm() + 1.0)) * F +
             (lambda * (J - 1.0) - 0.75 * mu + flat + pressure) * cofactors(F);
    }
    const Matrix3 e = strain(F);
    if (averages()) return rotation(F) * (2.0 * lame.mu * deviator(e) + pressure * Matrix3::Identity());
    return rotation(F) * (2.0 * lame.mu * e + lame.lambda * e.trace() * Matrix3::Identity());
  }

  void addForces(std::size_t e, const Matrix3& P, NodalVectors& forces) const {
    const Tetrahedron& nodes = mesh_.tetrahedra[e];
    const Matrix3 H = -volume(e) * P * edgeMatrix(mesh_.positions, nodes).inverse().transpose();
    for (int i = 0; i < 3; ++i) {
      forces.col(nodes[i + 1]) += H.col(i);
      forces.col(nodes[0]) -= H.col(i);
    }
  }

  NodalVectors plainForces(const NodalVectors& x) const {
    NodalVectors forces = NodalVectors::Zero(3, x.cols());
    const std::vector<double> pressures = patchPressures(x);
    for (std::size_t e = 0; e < mesh_.tetrahedra.size(); ++e) {
      addForces(e, stress(lameParameters(materials_.of(e)), gradient(x, e), pressures[e]), forces);
    }
    return forces;
  }

  TetMesh mesh_ = makeBlockMesh({Vector3(0.03, 0.01, 0.01), {3, 1, 1}, {}});
  ElementMaterials materials_;
  std::vector<int> patch_of_;
};

double difference(const NodalVectors& forces, const NodalVectors& expected) {
  return (forces - expected).cwiseAbs().maxCoeff() / expected.cwiseAbs().maxCoeff();
}

TEST_P(PlainForces, AreThoseOfTheKernels) {
  ASSERT_EQ(mesh_.tetrahedra.size(), 15U);
  const auto elasticity = makeElasticity();
  NodalVectors forces(3, mesh_.positions.cols());
  for (const double height : {1.1, 0.9, 0.4}) {
    const auto state = elasticity->makeState();
    const NodalVectors x = deformed(height);
    // The rotation of the first update is off by up to 1e-8 rad, Newton's last step.
    for (int k = 0; k < 2; ++k) elasticity->update(x, *state, forces);
    EXPECT_LE(difference(forces, plainForces(x)), 1e-12) << height;
  }
}

INSTANTIATE_TEST_SUITE_P(, PlainForces,
                         testing::Values(Case{"Linear", ElasticModel::kLinear, Dilatation::kElement},
                                         Case{"AveragedLinear", ElasticModel::kLinear, Dilatation::kPatch},
                                         Case{"Corotational", ElasticModel::kCorotational, Dilatation::kElement},
                                         Case{"AveragedCorotational", ElasticModel::kCorotational, Dilatation::kPatch},
                                         Case{"NeoHookean", ElasticModel::kNeoHookean, Dilatation::kElement},
                                         Case{"AveragedNeoHookean", ElasticModel::kNeoHookean, Dilatation::kPatch}),
                         [](const auto& one) { return std::string(one.param.name); });

class PlainOverstress : public PlainForces {};

/// Three steps of 10 ms, from rest on, of two terms.
TEST_P(PlainOverstress, IsThatOfTheKernel) {
  constexpr double kStep = 0.01;
  const std::vector<PronyTerm> terms = {{0.5, 0.02}, {1.5, 2.0}};
  for (MaterialDescription& material : materials_.materials) material.prony_series = terms;
  const auto elasticity = makeElasticity();
  const auto state = elasticity->makeState();
  std::vector<Matrix3> last(mesh_.tetrahedra.size(), Matrix3::Zero());
  std::vector<std::vector<Matrix3>> held(terms.size(), last);
  NodalVectors forces(3, mesh_.positions.cols());
  for (const double height : {1.0, 0.9, 0.8}) {
    const NodalVectors x = deformed(height);
    NodalVectors expected = plainForces(x);
    for (std::size_t e = 0; e < mesh_.tetrahedra.size(); ++e) {
      const Matrix3 F = gradient(x, e);
      const Matrix3 now = deviator(strain(F));
      for (std::size_t k = 0; k < terms.size(); ++k) {
        const double past = kStep / terms[k].time_s;
        held[k][e] = std::exp(-past) * held[k][e] + (1.0 - std::exp(-past)) / past * (now - last[e]);
        addForces(e,
                  rotation(F) * (2.0 * lameParameters(materials_.of(e)).mu * terms[k].modulus_ratio * std::exp(-past) *
                                 held[k][e]),
                  expected);
      }
      last[e] = now;
    }
    state->step_s = kStep;
    state->elapsed_s = kStep;
    elasticity->update(x, *state, forces);
    EXPECT_LE(difference(forces, expected), 2e-8) << height;  // the rotation is off by Newton's last step
  }
}

INSTANTIATE_TEST_SUITE_P(, PlainOverstress,
                         testing::Values(Case{"Linear", ElasticModel::kLinear, Dilatation::kElement},
                                         Case{"Corotational", ElasticModel::kCorotational, Dilatation::kElement},
                                         Case{"AveragedNeoHookean", ElasticModel::kNeoHookean, Dilatation::kPatch}),
                         [](const auto& one) { return std::string(one.param.name); });

}  // namespace
}  // namespace tissue_contact
