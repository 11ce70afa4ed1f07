/// The forces that the kernels compute for four elements at a time against the formulas of the models' heads, element by element and in
/// plain loops: 15 elements, so that the last batch is filled up, of two materials.
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>
#include <random>
#include <string>
#include <vector>

#include "tissue/element_patches.h"
#include "tissue/mean_strain.h"
#include "tissue_contact/mesh/tet_mesh.h"
#include "tissue_contact/tissue/make_elasticity.h"
#include "tissue_contact/tissue/tet_elasticity.h"

namespace tissue_contact {
namespace plain_forces_test {

struct Case {
  const char* name;
  ElasticModel model;
  Dilatation dilatation;
  Distortion distortion = Distortion::kElement;
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
    soft.distortion = GetParam().distortion;
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

  /// Of the patches' elements together, all by patch.
  struct Mean {
    double volume = 0.0;
    LameParameters bulk_and_mu;
    Matrix3 F = Matrix3::Zero();
    double J = 0.0;
  };
  std::vector<Mean> means(const NodalVectors& x) const {
    std::vector<Mean> means(mesh_.tetrahedra.size());
    for (std::size_t e = 0; e < mesh_.tetrahedra.size(); ++e) {
      const LameParameters lame = lameParameters(materials_.of(e));
      const double V = volume(e);
      Mean& mean = means[patch_of_[e]];
      mean.volume += V;
      mean.bulk_and_mu.lambda += V * (lame.lambda + 2.0 / 3.0 * lame.mu);
      mean.bulk_and_mu.mu += V * lame.mu;
      mean.F += V * gradient(x, e);
      mean.J += V * gradient(x, e).determinant();
    }
    for (Mean& mean : means) {
      mean.bulk_and_mu.lambda /= mean.volume;
      mean.bulk_and_mu.mu /= mean.volume;
      mean.F /= mean.volume;
      mean.J /= mean.volume;
    }
    return means;
  }
  double patchShare() const { return GetParam().distortion == Distortion::kPatch ? kPatchShapeShare : 0.0; }

  /// Stress of neo_hookean.h, Pa. @param pressure to the factor of dJ/dF.
  static Matrix3 neoHookean(const Matrix3& F, double lambda, double mu, double pressure) {
    return mu * (1.0 - 1.0 / (F.squaredNorm() + 1.0)) * F +
           (lambda * (F.determinant() - 1.0) - 0.75 * mu + pressure) * cofactors(F);
  }
  Matrix3 neoHookeanStress(const LameParameters& lame, const Matrix3& F, const Mean& mean) const {
    const double mu = 4.0 / 3.0 * lame.mu;
    const double lambda = averages() ? mu / 8.0 : lame.lambda + 5.0 / 6.0 * lame.mu;
    const bool patches = averages() || patchShare() > 0.0;
    const double flat = patches ? 16.0 * mu * std::min(0.0, F.determinant() - 0.3) : 0.0;
    const double pressure = averages() ? mean.bulk_and_mu.lambda * (mean.J - 1.0) : 0.0;
    const double mean_mu = 4.0 / 3.0 * mean.bulk_and_mu.mu;
    const double mean_lambda = averages() ? mean_mu / 8.0 : mean.bulk_and_mu.lambda + 1.0 / 6.0 * mean.bulk_and_mu.mu;
    const double own = 1.0 - patchShare();
    return neoHookean(F, own * lambda, own * mu, flat + pressure) +
           neoHookean(mean.F, patchShare() * mean_lambda, patchShare() * mean_mu, 0.0);
  }

  /// First Piola-Kirchhoff stress of an element, Pa. @param mean of its patch.
  Matrix3 stress(const LameParameters& lame, const Matrix3& F, const Mean& mean) const {
    if (GetParam().model == ElasticModel::kNeoHookean) return neoHookeanStress(lame, F, mean);
    const Matrix3 e = strain(F);
    if (!averages()) return rotation(F) * (2.0 * lame.mu * e + lame.lambda * e.trace() * Matrix3::Identity());
    const Matrix3 of_patch = strain(mean.F);
    return rotation(F) * (2.0 * (1.0 - patchShare()) * lame.mu * deviator(e)) +
           rotation(mean.F) * (2.0 * patchShare() * mean.bulk_and_mu.mu * deviator(of_patch) +
                               mean.bulk_and_mu.lambda * of_patch.trace() * Matrix3::Identity());
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
    const std::vector<Mean> patches = means(x);
    for (std::size_t e = 0; e < mesh_.tetrahedra.size(); ++e) {
      addForces(e, stress(lameParameters(materials_.of(e)), gradient(x, e), patches[patch_of_[e]]), forces);
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

INSTANTIATE_TEST_SUITE_P(
    , PlainForces,
    testing::Values(Case{"Linear", ElasticModel::kLinear, Dilatation::kElement},
                    Case{"AveragedLinear", ElasticModel::kLinear, Dilatation::kPatch},
                    Case{"MeanStrainLinear", ElasticModel::kLinear, Dilatation::kPatch, Distortion::kPatch},
                    Case{"Corotational", ElasticModel::kCorotational, Dilatation::kElement},
                    Case{"AveragedCorotational", ElasticModel::kCorotational, Dilatation::kPatch},
                    Case{"MeanStrainCorotational", ElasticModel::kCorotational, Dilatation::kPatch, Distortion::kPatch},
                    Case{"NeoHookean", ElasticModel::kNeoHookean, Dilatation::kElement},
                    Case{"AveragedNeoHookean", ElasticModel::kNeoHookean, Dilatation::kPatch},
                    Case{"SharedNeoHookean", ElasticModel::kNeoHookean, Dilatation::kAuto, Distortion::kPatch},
                    Case{"AveragedSharedNeoHookean", ElasticModel::kNeoHookean, Dilatation::kPatch,
                         Distortion::kPatch}),
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

}  // namespace plain_forces_test
}  // namespace tissue_contact
