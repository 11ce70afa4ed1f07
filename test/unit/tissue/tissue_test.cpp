/// A tissue as the simulator sees it: placed, weighed, fixed; from blocks and from real organ meshes.
#include "tissue_contact/tissue/tissue.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <limits>
#include <stdexcept>

namespace tissue_contact {
namespace {

TissueDescription blockDescription() {
  TissueDescription description;
  description.name = "block";
  BlockDescription block;
  block.size_m = Vector3(0.04, 0.03, 0.02);
  block.cells = {4, 3, 2};
  description.geometry = block;
  description.material = {ElasticModel::kCorotational, 5e3, 0.45, 1050.0};
  description.fixed = {PlaneRegion{}};
  return description;
}

TEST(Tissue, WeighsDensityTimesVolume) {
  const Tissue tissue(blockDescription(), Pose::Identity());
  EXPECT_NEAR(tissue.nodeMasses().sum(), 1050.0 * 0.04 * 0.03 * 0.02, 1e-15);
  EXPECT_GT(tissue.nodeMasses().minCoeff(), 0.0);
}

TEST(Tissue, RegionsAreInItsOwnFrameAndPositionsInTheWorld) {
  Pose X_WT = Pose::Identity();
  X_WT.translation() = Vector3(1.0, 2.0, 3.0);
  X_WT.linear() = Eigen::AngleAxisd(M_PI / 2.0, Vector3::UnitY()).toRotationMatrix();  // its z axis is the world's x
  const Tissue tissue(blockDescription(), X_WT);
  int fixed = 0;
  for (int i = 0; i < tissue.nodeCount(); ++i) {
    if (!tissue.fixed()[i]) continue;
    ++fixed;
    EXPECT_NEAR(tissue.restPositions()(0, i), 1.0, 1e-12);
  }
  EXPECT_EQ(fixed, 5 * 4);
}

TEST(Tissue, RefusesBadDensityDampingAndEmptyRegions) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  TissueDescription description = blockDescription();
  description.material.density_kg_per_m3 = nan;
  EXPECT_THROW(Tissue(description, Pose::Identity()), std::invalid_argument);
  description = blockDescription();
  description.damping.mass_per_s = -1.0;
  EXPECT_THROW(Tissue(description, Pose::Identity()), std::invalid_argument);
  description = blockDescription();
  description.damping.stiffness_s = nan;
  EXPECT_THROW(Tissue(description, Pose::Identity()), std::invalid_argument);
  description = blockDescription();
  description.fixed = {SphereRegion{Vector3(1.0, 0.0, 0.0), 0.01}};
  EXPECT_THROW(Tissue(description, Pose::Identity()), std::invalid_argument);
}

struct Organ {
  const char* file;
  double scale;
  double volume_m3;  ///< sum of the tetrahedra, computed from the raw file in exact arithmetic by a separate script
  bool has_unreferenced_node;
};

class OrganTest : public ::testing::TestWithParam<Organ> {};

TEST_P(OrganTest, LoadsWithScaleVolumeAndFixedRegion) {
  const std::string path = std::string(TISSUE_CONTACT_SHARED_DATA) + "/organs/" + GetParam().file;
  if (!std::filesystem::exists(path))
    GTEST_SKIP() << path << " is not there: organ meshes are not part of the repository";
  TissueDescription description = blockDescription();
  description.geometry = MeshDescription{path, GetParam().scale, GetParam().has_unreferenced_node};
  description.fixed = {};
  const Tissue all_free(description, Pose::Identity());
  EXPECT_NEAR(all_free.nodeMasses().sum() / 1050.0, GetParam().volume_m3, 1e-9 * GetParam().volume_m3);
  // The lowest tenth held, as a surgeon's scene would.
  const Vector3 low = all_free.restPositions().rowwise().minCoeff();
  const Vector3 high = all_free.restPositions().rowwise().maxCoeff();
  const double level = low.z() + 0.1 * (high.z() - low.z());
  description.fixed = {PlaneRegion{Vector3(0.0, 0.0, level), Vector3::UnitZ()}};
  const Tissue tissue(description, Pose::Identity());
  int fixed = 0;
  for (int i = 0; i < tissue.nodeCount(); ++i) {
    EXPECT_EQ(tissue.fixed()[i], tissue.restPositions()(2, i) <= level);
    fixed += tissue.fixed()[i];
  }
  EXPECT_GT(fixed, 0);
  EXPECT_LT(fixed, tissue.nodeCount() / 2);
}

INSTANTIATE_TEST_SUITE_P(Organs, OrganTest,
                         ::testing::Values(Organ{"liver_volumetric.vtk", 0.001, 1179442.2831651319e-9, false},
                                           Organ{"gallbladder_volumetric.vtk", 0.001, 34122.545206922296e-9, true},
                                           Organ{"tissue_volume.msh", 1.0, 0.00011520248296851886, false}),
                         [](const auto& parameter) {
                           const std::string file = parameter.param.file;
                           return file.substr(0, file.find('.'));
                         });

}  // namespace
}  // namespace tissue_contact
