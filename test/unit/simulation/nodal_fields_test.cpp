/// @file
/// What pictures show per node: strain of deformations that are known, pressure of forces that are.
#include "simulation/nodal_fields.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "support/text_scene.h"
#include "tissue_contact/simulation/law_error.h"

namespace tissue_contact {
namespace nodal_fields_test {

Tissue blockTissue() {
  const Simulator simulator = makeSimulator(blockScene());
  return Tissue(simulator.scene().tissues[0], Pose::Identity());
}

Tissue sheetTissue() {
  const Simulator simulator = makeSimulator(
      "tissues:\n  - name: sheet\n    sheet: {size_m: [0.06, 0.04], cells: [6, 4], thickness_m: 0.001}\n    material: "
      "{model: membrane, youngs_modulus_pa: 1e5, poissons_ratio: 0.4, density_kg_per_m3: 1000}\n");
  return Tissue(simulator.scene().tissues[0], Pose::Identity());
}

VectorX strainOf(const Tissue& tissue, const Matrix3& F) {
  VectorX strain;
  nodalStrain(tissue.tetrahedra(), tissue.surface(), tissue.restPositions(), F * tissue.restPositions(), strain);
  return strain;
}

TEST(NodalStrain, OfAnAffineDeformationIsThatOfEveryElement) {
  Matrix3 F;
  F << 1.1, 0.05, 0.0, 0.0, 0.9, 0.1, 0.02, 0.0, 1.05;
  const VectorX strain = strainOf(blockTissue(), F);
  EXPECT_TRUE(((strain.array() - equivalentStrain(F)).abs() < 1e-9).all()) << strain;
  EXPECT_GT(strain.minCoeff(), 0.1);
}

TEST(NodalStrain, RotationsAreNone) {
  const Matrix3 R = Eigen::AngleAxisd(1.1, Vector3(1, 2, 3).normalized()).toRotationMatrix();
  EXPECT_LT(strainOf(blockTissue(), R).maxCoeff(), 1e-9);
  EXPECT_LT(strainOf(sheetTissue(), R).maxCoeff(), 1e-7);
}

TEST(NodalStrain, OfASheetIsThatInItsPlane) {
  const Matrix3 F = Vector3(1.2, 1.0, 1.0).asDiagonal();
  const Matrix3 R = Eigen::AngleAxisd(0.7, Vector3(3, 1, 1).normalized()).toRotationMatrix();
  const VectorX strain = strainOf(sheetTissue(), R * F);
  EXPECT_TRUE(((strain.array() - equivalentStrain(F)).abs() < 1e-9).all()) << strain;
}

/// A force straight down on a surface point.
SolvedContact push(int node, double force_n) {
  SolvedContact solved;
  solved.contact.key.tissue = 0;
  solved.contact.nodes = {node, 0, 0};
  solved.contact.weights = Vector3(1, 0, 0);
  solved.contact.R_WC = contactFrame(Vector3(0, 0, -1));
  solved.state = ContactState::kStatic;
  solved.force_on_tissue_n = Vector3(0.5 * force_n, 0, -force_n);  // and sideways, which is no pressure
  return solved;
}

/// Node of the surface nearest to a point.
int nodeAt(const Tissue& tissue, const Vector3& p) {
  Eigen::Index node = 0;
  (tissue.restPositions().colwise() - p).colwise().norm().minCoeff(&node);
  return static_cast<int>(node);
}

TEST(NodalPressure, TimesAreaIsTheForce) {
  for (const Tissue& tissue : {blockTissue(), sheetTissue()}) {
    const bool is_sheet = tissue.tetrahedra().empty();
    NodalVectors areas;
    nodalAreas(tissue.surface(), tissue.restPositions(), areas);
    const int node = nodeAt(tissue, Vector3(0, 0, is_sheet ? 0.0 : 0.02));
    VectorX pressure;
    nodalPressure({push(node, 0.2), push(node, 0.1)}, 0, areas, is_sheet, pressure);
    EXPECT_NEAR(pressure[node] * areas.col(node).norm(), 0.3, 1e-12);
    EXPECT_EQ((pressure.array() > 0.0).count(), 1);
    nodalPressure({push(node, 0.3)}, 1, areas, is_sheet, pressure);  // another tissue's
    EXPECT_EQ(pressure.maxCoeff(), 0.0);
  }
}

TEST(NodalPressure, IsNotNegativeAndOverlooksNodesThatAreNotThere) {
  const Tissue tissue = blockTissue();
  NodalVectors areas;
  nodalAreas(tissue.surface(), tissue.restPositions(), areas);
  EXPECT_NEAR(areas.rowwise().sum().norm(), 0.0, 1e-15);  // closed
  const int below = nodeAt(tissue, Vector3(0, 0, 0));
  VectorX pressure;
  nodalPressure({push(below, 0.2), push(tissue.nodeCount(), 1.0)}, 0, areas, false, pressure);
  EXPECT_EQ(pressure.size(), tissue.nodeCount());
  EXPECT_EQ(pressure.maxCoeff(), 0.0);
  EXPECT_EQ(pressure.minCoeff(), 0.0);
}

}  // namespace nodal_fields_test
}  // namespace tissue_contact
