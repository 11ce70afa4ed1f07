/// A tissue as the simulator sees it: placed, weighed, fixed; from blocks and from real organ meshes.
#include "tissue_contact/tissue/tissue.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <limits>
#include <stdexcept>

#include "support/refusal.h"

namespace tissue_contact {
namespace tissue_test {

TissueDescription blockDescription() {
  TissueDescription description;
  description.name = "block";
  description.geometry = BlockDescription{Vector3(0.04, 0.03, 0.02), {4, 3, 2}, {}};
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

TissueDescription sheetDescription() {
  TissueDescription description;
  description.name = "flap";
  description.geometry = SheetDescription{Vector2(0.04, 0.02), {4, 2}, 2e-3};
  description.material = {ElasticModel::kMembrane, 1e5, 0.3, 1100.0};
  return description;
}

/// A region of `blockDescription` above z, by default like the rest of it.
TissueRegion regionAbove(double z) {
  TissueRegion region;
  region.name = "capsule";
  region.where = {BoxRegion{Vector3(-1.0, -1.0, z), Vector3(1.0, 1.0, 1.0)}};
  region.material = blockDescription().material;
  return region;
}

void expectRefused(const TissueDescription& description, const std::vector<std::string>& words) {
  expectRefusal([&] { Tissue(description, Pose::Identity()); }, words);
}

TEST(Tissue, EveryModelComesByName) {
  TissueDescription description = blockDescription();
  for (const ElasticModel model :
       {ElasticModel::kLinear, ElasticModel::kCorotational, ElasticModel::kNeoHookean, ElasticModel::kMassSpring}) {
    description.material.model = model;
    const Tissue tissue(description, Pose::Identity());
    EXPECT_EQ(tissue.thickness(), 0.0);
    EXPECT_EQ(tissue.elasticity().makeState()->stiffness.rows(), tissue.nodeCount());
    EXPECT_TRUE(tissue.surfaceRegions().empty());
    EXPECT_TRUE(tissue.surfaceFibres().empty());
  }
}

TEST(Tissue, ASheetIsAMembraneThatTouchesOnBothSides) {
  const Tissue tissue(sheetDescription(), Pose::Identity());
  EXPECT_EQ(tissue.thickness(), 2e-3);
  EXPECT_TRUE(tissue.tetrahedra().empty());
  EXPECT_EQ(tissue.surface().size(), 16U);
  EXPECT_NEAR(tissue.nodeMasses().sum(), 1100.0 * 0.04 * 0.02 * 2e-3, 1e-15);
  EXPECT_GT(tissue.nodeMasses().minCoeff(), 0.0);
}

TEST(Tissue, RefusesModelsThatDoNotSuitTheGeometry) {
  TissueDescription description = blockDescription();
  description.material.model = ElasticModel::kMembrane;
  expectRefused(description, {"tissue 'block'", "'membrane'", "volume", "corotational"});
  description = sheetDescription();
  description.material.model = ElasticModel::kLinear;
  expectRefused(description, {"tissue 'flap'", "'linear'", "must be a membrane"});
  description = blockDescription();
  description.regions = {regionAbove(0.01)};
  description.regions[0].material.model = ElasticModel::kNeoHookean;
  expectRefused(description, {"tissue 'block', region 'capsule'", "'neo_hookean'", "'corotational'"});
  description.regions[0].material = description.material;
  description.regions[0].material.dilatation = Dilatation::kElement;
  expectRefused(description, {"tissue 'block', region 'capsule'", "dilatation"});
  description.regions[0].material = description.material;
  description.regions[0].material.distortion = Distortion::kElement;
  expectRefused(description, {"tissue 'block', region 'capsule'", "distortion"});
  description = blockDescription();
  description.material.distortion = Distortion::kPatch;
  EXPECT_NO_THROW(Tissue(description, Pose::Identity()));
  description.material.prony_series = {{0.5, 0.1}};
  expectRefused(description, {"tissue 'block'", "distortion", "remove the key, or prony_series"});
  description.material.prony_series.clear();
  description.material.dilatation = Dilatation::kElement;
  expectRefused(description, {"tissue 'block'", "distortion is 'patch' while dilatation is 'element'"});
  description = blockDescription();
  description.material.distortion = Distortion::kPatch;
  description.material.model = ElasticModel::kNeoHookean;
  EXPECT_NO_THROW(Tissue(description, Pose::Identity()));
  description.material.model = ElasticModel::kMassSpring;
  description.material.poissons_ratio = 0.25;
  expectRefused(description, {"tissue 'block'",
                              "distortion is 'patch', which only the models linear, corotational and neo_hookean"});
  description = sheetDescription();
  std::get<SheetDescription>(description.geometry).thickness_m = 0.0;
  expectRefused(description, {"tissue 'flap'", "thickness_m", "> 0"});
}

TEST(Tissue, RegionsHoldElementsAndSurfaceByCentroidLastOneFirst) {
  TissueDescription description = blockDescription();  // two layers of cells, up to z = 0.02
  description.regions = {regionAbove(0.01), regionAbove(0.0199)};
  description.regions[0].material.density_kg_per_m3 = 2100.0;
  description.regions[1].name = "face";  // holds no element, only the upper face's triangles
  Pose X_WT = Pose::Identity();
  X_WT.translation() = Vector3(5.0, 5.0, 5.0);  // regions are in the tissue's frame
  const Tissue tissue(description, X_WT);
  EXPECT_NEAR(tissue.nodeMasses().sum(), 0.04 * 0.03 * 0.01 * (1050.0 + 2100.0), 1e-13);
  ASSERT_EQ(tissue.surfaceRegions().size(), tissue.surface().size());
  for (std::size_t t = 0; t < tissue.surface().size(); ++t) {
    double z = -5.0;
    for (const int node : tissue.surface()[t]) z += tissue.restPositions()(2, node) / 3.0;
    EXPECT_EQ(tissue.surfaceRegions()[t], z > 0.0199 ? 1 : (z > 0.01 ? 0 : -1)) << z;
  }
}

/// Elastic forces with the corner of the block at the origin pulled out.
NodalVectors forcesWithACornerPulled(const TissueDescription& description) {
  const Tissue tissue(description, Pose::Identity());
  NodalVectors x = tissue.restPositions();
  x.col(0) -= Vector3(0.001, 0.002, 0.003);
  x.col(x.cols() - 1) += Vector3(0.002, 0.003, 0.001);
  NodalVectors forces(3, tissue.nodeCount());
  const auto state = tissue.elasticity().makeState();
  tissue.elasticity().update(x, *state, forces);
  return forces;
}

// A region may be there for its friction or its fibres. Half of its cells' elements apart, patches were cut and tissue up to 23 % stiffer.
TEST(Tissue, RegionsOfTheSameStiffnessPartNoPatches) {
  TissueDescription description = blockDescription();
  description.material.poissons_ratio = 0.45;
  const NodalVectors whole = forcesWithACornerPulled(description);
  description.regions = {regionAbove(0.015)};  // in the middle of a layer of cells
  description.regions[0].material = description.material;
  description.regions[0].damping_stiffness_s = description.damping.stiffness_s;
  description.regions[0].fibre_direction = Vector3::UnitX();
  EXPECT_EQ(forcesWithACornerPulled(description), whole);
  description.regions[0].material.youngs_modulus_pa *= 1.0 + 1e-12;  // parts them
  EXPECT_GT((forcesWithACornerPulled(description) - whole).norm(), 0.005 * whole.norm());
}

TEST(Tissue, RefusesRegionsWithoutEffectOrWithBadNumbers) {
  TissueDescription description = blockDescription();
  description.regions = {regionAbove(0.5)};
  expectRefused(description, {"tissue 'block'", "region 'capsule'", "holds no element"});
  description.regions = {regionAbove(0.0199)};  // surface triangles only, which a material cannot be for
  description.regions[0].material.youngs_modulus_pa = 1e4;
  expectRefused(description, {"region 'capsule'", "holds no element"});
  description.regions = {regionAbove(0.01), regionAbove(0.0)};
  expectRefused(description, {"region 'capsule'", "later regions"});
  description.regions = {regionAbove(0.01)};
  description.regions[0].material.poissons_ratio = 0.5;
  expectRefused(description, {"region 'capsule'", "poissons_ratio"});
  description.regions = {regionAbove(0.01)};
  description.regions[0].material.density_kg_per_m3 = 0.0;
  expectRefused(description, {"region 'capsule'", "density_kg_per_m3"});
  description.regions = {regionAbove(0.01)};
  description.regions[0].damping_stiffness_s = -1.0;
  expectRefused(description, {"region 'capsule'", "stiffness_s"});
}

TEST(Tissue, DampingIsOneNumberWhereItIsTheSameEverywhere) {
  TissueDescription description = blockDescription();
  description.damping = {1.5, 0.01};
  description.regions = {regionAbove(0.01)};
  description.regions[0].damping_stiffness_s = 0.01;
  const Tissue uniform(description, Pose::Identity());
  EXPECT_EQ(uniform.damping().stiffness_s, 0.01);
  EXPECT_EQ(uniform.elasticity().makeState()->damping.rows(), 0);
  description.regions[0].damping_stiffness_s = 0.02;
  const Tissue layered(description, Pose::Identity());
  EXPECT_EQ(layered.damping().stiffness_s, 0.0);
  EXPECT_EQ(layered.damping().mass_per_s, 1.5);
  EXPECT_EQ(layered.elasticity().makeState()->damping.rows(), layered.nodeCount());
}

TEST(Tissue, FibresLieInTheSurfaceAndAreCarriedByIt) {
  TissueDescription description = blockDescription();
  description.fibre_direction = Vector3(3.0, 0.0, 1.0);
  description.regions = {regionAbove(0.0199)};
  description.regions[0].fibre_direction = Vector3(0.0, 0.2, 0.0);
  Pose X_WT = Pose::Identity();
  X_WT.linear() = Eigen::AngleAxisd(1.1, Vector3(1.0, 2.0, 3.0).normalized()).toRotationMatrix();
  const Tissue tissue(description, X_WT);
  ASSERT_EQ(tissue.surfaceFibres().size(), tissue.surface().size());
  int across = 0;
  for (std::size_t t = 0; t < tissue.surface().size(); ++t) {
    const Triangle& nodes = tissue.surface()[t];
    const Vector3 e1 = tissue.restPositions().col(nodes[1]) - tissue.restPositions().col(nodes[0]);
    const Vector3 e2 = tissue.restPositions().col(nodes[2]) - tissue.restPositions().col(nodes[0]);
    const Vector3 carried = tissue.surfaceFibres()[t].x() * e1 + tissue.surfaceFibres()[t].y() * e2;
    const Vector3 normal = e1.cross(e2).normalized();
    const Vector3 fibre = tissue.surfaceRegions()[t] < 0 ? Vector3(3.0, 0.0, 1.0) : Vector3(0.0, 1.0, 0.0);
    const Vector3 projected = X_WT.linear() * fibre - normal.dot(X_WT.linear() * fibre) * normal;
    if (projected.norm() < 1e-9) {
      ++across;
      EXPECT_EQ(tissue.surfaceFibres()[t], Vector2(0.0, 0.0));
    } else {
      EXPECT_LE((carried - projected.normalized()).norm(), 1e-12);
    }
  }
  EXPECT_EQ(across, 0);  // (3, 0, 1) lies across no face of the block
  description.fibre_direction = Vector3(0.0, 0.0, 1.0);
  description.regions.clear();
  const Tissue upright(description, Pose::Identity());
  for (std::size_t t = 0; t < upright.surface().size(); ++t) across += upright.surfaceFibres()[t].isZero(0.0);
  EXPECT_EQ(across, 2 * 2 * 4 * 3);  // the upper and the lower face
  description.fibre_direction = Vector3(0.0, std::nan(""), 1.0);
  expectRefused(description, {"tissue 'block'", "fibre_direction", "finite"});
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

}  // namespace tissue_test
}  // namespace tissue_contact
