/// Strain recovered from linear tetrahedra: where its error is nothing, that turning changes nothing, its order, and materials.
#include "tissue/strain_recovery.h"

#include <gtest/gtest.h>

#include <limits>

namespace tissue_contact {
namespace strain_recovery_test {

constexpr double kEverywhere = std::numeric_limits<double>::infinity();
const Vector3 kMiddle(0.0, 0.0, 0.02);

/// 40 mm on each side, on z = 0, its upper half a region of its own if asked for.
Tissue cube(int cells, bool has_region = false) {
  TissueDescription description;
  description.name = "cube";
  BlockDescription block;
  block.size_m = Vector3::Constant(0.04);
  block.cells = {cells, cells, cells};
  description.geometry = block;
  description.material = {ElasticModel::kCorotational, 5000.0, 0.45, 1000.0};
  if (has_region) {
    TissueRegion upper;
    upper.name = "upper";
    upper.where = {BoxRegion{Vector3(-1.0, -1.0, 0.02), Vector3(1.0, 1.0, 1.0)}};
    upper.material = description.material;
    upper.material.youngs_modulus_pa = 500.0;
    description.regions = {upper};
  }
  return Tissue(description, Pose::Identity());
}

template <typename Map>
NodalVectors moved(const Tissue& tissue, const Map& map) {
  NodalVectors x = tissue.restPositions();
  for (Eigen::Index i = 0; i < x.cols(); ++i) x.col(i) = map(Vector3(x.col(i)));
  return x;
}

/// Sheared by 10 z^2: a strain that is linear, with a slope that cells of h miss by h.
Vector3 bent(const Vector3& X) { return X + Vector3(10.0 * X.z() * X.z(), 0.0, 0.0); }

double errorOf(const Tissue& tissue, const NodalVectors& x, double radius_m = kEverywhere) {
  return recoveredStrainError(tissue, {1700.0, 170.0}, x, kMiddle, radius_m);
}

TEST(StrainRecovery, AffineDeformationHasNoError) {
  const Tissue tissue = cube(4);
  Matrix3 F;
  F << 1.2, 0.3, 0.0, -0.1, 0.9, 0.2, 0.0, 0.1, 1.1;
  EXPECT_LT(errorOf(tissue, moved(tissue, [&](const Vector3& X) -> Vector3 { return F * X; })), 1e-24);
}

TEST(StrainRecovery, NothingIsKnownOfARigidMotion) {
  const Tissue tissue = cube(2);
  EXPECT_EQ(errorOf(tissue, tissue.restPositions()), 0.0);
  // An energy of round-off alone must not pass for an estimate that is not finite.
  const Matrix3 R = Eigen::AngleAxisd(0.7, Vector3(1.0, 2.0, -1.0).normalized()).toRotationMatrix();
  EXPECT_TRUE(std::isfinite(errorOf(tissue, moved(tissue, [&](const Vector3& X) -> Vector3 { return R * X; }))));
}

TEST(StrainRecovery, TurningChangesNothing) {
  const Tissue tissue = cube(4);
  const double error = errorOf(tissue, moved(tissue, bent));
  const Matrix3 R = Eigen::AngleAxisd(1.3, Vector3(1.0, 2.0, -1.0).normalized()).toRotationMatrix();
  const auto turned = moved(tissue, [&](const Vector3& X) -> Vector3 { return R * bent(X) + Vector3(0.1, 0.0, 0.0); });
  EXPECT_GT(error, 1e-3);
  EXPECT_NEAR(errorOf(tissue, turned), error, 1e-12 * error + 1e-15);
}

// Away from the surface, where nodes have elements on all sides: an energy's error is of order h^2.
TEST(StrainRecovery, IsOfSecondOrderInTheCells) {
  const auto error = [](int cells) {
    const Tissue tissue = cube(cells);
    return errorOf(tissue, moved(tissue, bent), 0.01);
  };
  const double coarse = error(8);
  const double fine = error(16);
  EXPECT_NEAR(coarse / fine, 4.0, 0.8);
}

// The lower half at rest, the upper one sheared: each is affine.
TEST(StrainRecovery, StrainMayJumpBetweenMaterials) {
  const auto sheared_above = [](const Vector3& X) -> Vector3 {
    return X + Vector3(0.5 * std::max(X.z() - 0.02, 0.0), 0.0, 0.0);
  };
  const Tissue two = cube(4, true);
  EXPECT_LT(errorOf(two, moved(two, sheared_above)), 1e-24);
  const Tissue one = cube(4);
  EXPECT_GT(errorOf(one, moved(one, sheared_above)), 0.01);
}

TEST(StrainRecovery, LooksWithinTheRadiusAlone) {
  const Tissue tissue = cube(8);
  const auto bent_above = [](const Vector3& X) -> Vector3 { return X.z() > 0.034 ? bent(X) : X; };
  EXPECT_EQ(errorOf(tissue, moved(tissue, bent_above), 0.005), 0.0);
  EXPECT_GT(errorOf(tissue, moved(tissue, bent_above)), 0.0);
}

}  // namespace strain_recovery_test
}  // namespace tissue_contact
