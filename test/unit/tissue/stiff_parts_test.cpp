/// Which parts of a tissue are stiff enough for solvers to move each as one.
#include "tissue/stiff_parts.h"

#include <gtest/gtest.h>

#include <stdexcept>
#include <vector>

#include "tissue_contact/tissue/tissue.h"

namespace tissue_contact {
namespace stiff_parts_test {

/// A block of 6 x 4 x 2 cells of 10 mm with two lumps, each of eight cells around a node inside the block.
class TwoLumps : public ::testing::Test {
 protected:
  TwoLumps() {
    description_.name = "block";
    description_.geometry = BlockDescription{Vector3(0.06, 0.04, 0.02), {6, 4, 2}, {}};
    description_.material = {ElasticModel::kCorotational, 5e3, 0.45, 1050.0};
    for (const double x : {-0.02, 0.02}) {
      TissueRegion lump;
      lump.name = x < 0.0 ? "left" : "right";
      lump.where = {BoxRegion{Vector3(x - 0.0101, -0.0101, -0.01), Vector3(x + 0.0101, 0.0101, 0.03)}};
      lump.material = description_.material;
      lump.material.youngs_modulus_pa = 1e5;
      description_.regions.push_back(lump);
    }
  }

  /// Nodes of one of the lumps, by where they are.
  static std::vector<int> around(double x, const Tissue& tissue) {
    std::vector<int> nodes;
    for (int i = 0; i < tissue.nodeCount(); ++i) {
      const Vector3 at = tissue.restPositions().col(i) - Vector3(x, 0.0, 0.0);
      if (at.head<2>().cwiseAbs().maxCoeff() < 0.0101) nodes.push_back(i);
    }
    return nodes;
  }

  TissueDescription description_;
};

TEST_F(TwoLumps, AreTwoParts) {
  const Tissue tissue(description_, Pose::Identity());
  const std::vector<int> left = around(-0.02, tissue), right = around(0.02, tissue);
  ASSERT_EQ(left.size(), 27u);
  EXPECT_EQ(tissue.stiffParts(), (std::vector<std::vector<int>>{left, right}));
}

/// A bridge between them joins them: whatever is stiff counts, of one material or of several.
TEST_F(TwoLumps, AreOneWhereStiffTissueJoinsThem) {
  TissueRegion bridge = description_.regions[0];
  bridge.name = "bridge";
  bridge.where = {BoxRegion{Vector3(-0.0101, -0.0101, -0.01), Vector3(0.0101, 0.0101, 0.03)}};
  bridge.material.youngs_modulus_pa = 3e4;
  description_.regions.push_back(bridge);
  const Tissue tissue(description_, Pose::Identity());
  ASSERT_EQ(tissue.stiffParts().size(), 1u);
  EXPECT_EQ(tissue.stiffParts()[0].size(), 3u * 3u * 7u);  // the whole length of the block
}

/// By shear modulus against that of most of the volume; materials that change change them.
TEST_F(TwoLumps, ArePartsWhereTheyAreStiffEnough) {
  description_.regions[0].material.youngs_modulus_pa = 1.01 * kStiffRatio * 5e3;
  description_.regions[1].material.youngs_modulus_pa = 0.99 * kStiffRatio * 5e3;
  Tissue tissue(description_, Pose::Identity());
  EXPECT_EQ(tissue.stiffParts(), (std::vector<std::vector<int>>{around(-0.02, tissue)}));
  description_.material.youngs_modulus_pa *= 1.02;
  tissue.changeMaterials(description_);
  EXPECT_TRUE(tissue.stiffParts().empty());
  description_.material.youngs_modulus_pa *= 0.9;
  tissue.changeMaterials(description_);
  EXPECT_EQ(tissue.stiffParts().size(), 2u);
}

/// Of a mesh whose every part is a region, where the tissue's own material is nowhere.
TEST_F(TwoLumps, ArePartsBesideARegionThatHoldsTheRest) {
  for (const double own_pa : {500.0, 5e3, 5e5}) {
    TissueDescription description = description_;
    TissueRegion rest = description.regions[0];
    rest.name = "rest";
    rest.where = {BoxRegion{Vector3(-1.0, -1.0, -1.0), Vector3(1.0, 1.0, 1.0)}};
    rest.material.youngs_modulus_pa = 5e3;
    description.regions.insert(description.regions.begin(), rest);
    description.material.youngs_modulus_pa = own_pa;
    const Tissue tissue(description, Pose::Identity());
    EXPECT_EQ(tissue.stiffParts(), (std::vector<std::vector<int>>{around(-0.02, tissue), around(0.02, tissue)}));
  }
}

/// Where most of it is stiff, it is what is soft that is small: nothing moves as one.
TEST_F(TwoLumps, AreNoPartsWhereTheyAreSoft) {
  for (TissueRegion& lump : description_.regions) lump.material.youngs_modulus_pa = 500.0;
  EXPECT_TRUE(Tissue(description_, Pose::Identity()).stiffParts().empty());
}

}  // namespace stiff_parts_test
}  // namespace tissue_contact
