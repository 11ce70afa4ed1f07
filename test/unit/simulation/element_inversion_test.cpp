/// @file
/// How far a step may go before it turns elements inside out, and what is left of its velocities then.
#include "simulation/element_inversion.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <vector>

#include "simulation/energy_debt.h"

namespace tissue_contact {
namespace element_inversion_test {

constexpr double kStep_s = 0.01;

TissueDescription described() {
  TissueDescription description;
  description.name = "block";
  description.geometry = BlockDescription{Vector3(0.03, 0.02, 0.01), {3, 2, 1}, {}};
  description.material.youngs_modulus_pa = 5000.0;
  description.material.poissons_ratio = 0.3;
  description.material.density_kg_per_m3 = 1000.0;
  return description;
}

/// Of a step that would shorten the block, from a height that is `from` of that at rest, by `by` of it.
double shareOf(double from, double by) {
  const Tissue tissue(described(), Pose::Identity());
  NodalVectors x = tissue.restPositions();
  NodalVectors v = NodalVectors::Zero(3, x.cols());
  v.row(2) = -by * x.row(2) / kStep_s;
  v.colwise() += Vector3(50.0, -20.0, 10.0);  // as a whole it may go anywhere
  x.row(2) *= from;
  std::vector<char> scratch;
  return shareBeforeInversion(tissue, x, v, kStep_s, scratch);
}

TEST(ShareBeforeInversion, KeepsATwentiethOfTheVolumeOrHalfOfTheWay) {
  EXPECT_EQ(shareOf(1.0, 0.0), 1.0);
  EXPECT_EQ(shareOf(1.0, 0.94), 1.0);
  EXPECT_EQ(shareOf(1.0, 0.96), 0.7);
  EXPECT_EQ(shareOf(1.0, 1.4), 0.5);
  EXPECT_EQ(shareOf(1.0, 5.0), 0.5);
  EXPECT_EQ(shareOf(0.12, 0.08), 0.7);
}

TEST(ShareBeforeInversion, LeavesAloneWhatIsCrushedAlready) {
  EXPECT_EQ(shareOf(0.09, 0.08), 1.0);
  EXPECT_EQ(shareOf(-0.5, 3.0), 1.0);
}

TEST(ShareBeforeInversion, LooksAtNoSheet) {
  TissueDescription description = described();
  description.geometry = SheetDescription{Vector2(0.03, 0.02), {3, 2}, 0.001};
  description.material.model = ElasticModel::kMembrane;
  const Tissue sheet(description, Pose::Identity());
  std::vector<char> scratch;
  EXPECT_EQ(shareBeforeInversion(sheet, sheet.restPositions(), -1e3 * sheet.restPositions(), kStep_s, scratch), 1.0);
  EXPECT_EQ(sheet.smallestHeight(), 0.0);
}

TEST(SlowDown, KeepsTheMomentumOfAFreeBodyAlone) {
  const VectorX mass = Vector3(0.1, 0.2, 0.3);
  NodalVectors v(3, 3);
  v << 1.0, 2.0, -3.0, 0.5, 0.0, 4.0, 7.0, -1.0, 2.0;
  NodalVectors free = v;
  slowDown(mass, true, 0.7, free);
  EXPECT_LT((free * mass - v * mass).norm(), 1e-15);
  EXPECT_LT(((free.col(0) - free.col(1)) - 0.7 * (v.col(0) - v.col(1))).norm(), 1e-15);
  NodalVectors held = v;
  slowDown(mass, false, 0.7, held);
  EXPECT_LT((held - 0.7 * v).norm(), 1e-15);
}

TEST(SmallestHeight, IsThatOfACornerOverItsFace) {
  const Tissue tissue(described(), Pose::Identity());
  const NodalVectors& x = tissue.restPositions();
  double smallest = std::numeric_limits<double>::infinity();
  for (const Tetrahedron& element : tissue.tetrahedra()) {
    for (std::size_t top = 0; top < 4; ++top) {
      const Vector3 a = x.col(element[(top + 1) % 4]), b = x.col(element[(top + 2) % 4]),
                    c = x.col(element[(top + 3) % 4]);
      const Vector3 normal = (b - a).cross(c - a).normalized();
      smallest = std::min(smallest, std::abs(normal.dot(Vector3(x.col(element[top])) - a)));
    }
  }
  EXPECT_NEAR(tissue.smallestHeight(), smallest, 1e-12);
}

}  // namespace element_inversion_test
}  // namespace tissue_contact
