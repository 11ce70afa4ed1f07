/// @file
/// Parts of a coarse body that follows tools, before anything touches: regions, attachments and pressure hold what the scene says, not
/// what the elements of its file can show.
#include "tissue/body_edges.h"

#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "support/refusal.h"
#include "support/temporary_directory.h"
#include "support/tissue_files.h"
#include "tissue/placed_mesh.h"
#include "tissue_contact/mesh/tet_mesh.h"
#include "tissue_contact/mesh/triangle_mesh.h"

namespace tissue_contact {
namespace body_edges_test {

constexpr double kPi = 3.14159265358979323846;

/// 40 x 40 x 60 mm, whose cells from the file are 20 mm.
class CoarseBody : public testing::Test {
 protected:
  CoarseBody() {
    write(vtkOf(mesh_));
    tissue_.name = "body";
    tissue_.material = {ElasticModel::kCorotational, 5e3, 0.45, 1000.0};
    tissue_.refinement.mode = RefinementDescription::Mode::kAuto;
    tissue_.refinement.nodes_at_most = 20000;
  }

  void write(const std::string& text) {
    MeshDescription file;
    file.file = directory_.write("body.vtk", text);
    tissue_.geometry = file;
  }

  /// As it is while nothing touches.
  PlacedMesh placed() const {
    RefinableMesh made = refinableMesh(tissue_, nullptr, {});
    BisectedMesh mesh;
    EXPECT_TRUE(made.bisection.refine([](const Vector3&) { return 1.0; }, 20000, mesh));
    return placeMesh(made.description, Pose::Identity(), mesh);
  }

  void addRegion(const Region& where) {
    TissueRegion region;
    region.name = "part";
    region.where = {where};
    region.material = tissue_.material;
    region.material.youngs_modulus_pa = 5e4;
    tissue_.regions.push_back(region);
  }

  static double volumeOfRegion(const PlacedMesh& mesh) {
    double volume_m3 = 0.0;
    for (std::size_t e = 0; e < mesh.tetrahedra.size(); ++e) {
      if (mesh.element_regions[e] == 0) volume_m3 += signedVolume(mesh.rest, mesh.tetrahedra[e]);
    }
    return volume_m3;
  }

  static double pressedArea(const PlacedMesh& mesh) {
    double area_m2 = 0.0;
    for (const Triangle& triangle : mesh.pressed) area_m2 += triangleArea(mesh.rest, triangle);
    return area_m2;
  }

  const TetMesh mesh_ = makeBlockMesh({Vector3(0.04, 0.04, 0.06), {2, 2, 3}, {}}, BlockSplit::kSix);
  TissueDescription tissue_;

 private:
  TemporaryDirectory directory_;
};

// Between the centroids of cells of 20 mm: the file's elements cannot show it at all.
TEST_F(CoarseBody, HasARegionSmallerThanItsCells) {
  for (const double radius : {0.003, 0.005, 0.009}) {
    tissue_.regions.clear();
    addRegion(SphereRegion{{0.001, 0.002, 0.021}, radius});
    const double exact = 4.0 / 3.0 * kPi * radius * radius * radius;
    EXPECT_NEAR(volumeOfRegion(placed()) / exact, 1.0, 0.1) << radius;  // 0.035 RMS over 90 places
  }
}

TEST_F(CoarseBody, HasALayerOfARegionAsDeepAsItIs) {
  for (const double height : {0.008, 0.013, 0.022}) {
    tissue_.regions.clear();
    addRegion(PlaneRegion{{0.0, 0.0, height}, {0.0, 0.0, 1.0}});
    EXPECT_NEAR(volumeOfRegion(placed()) / (0.04 * 0.04 * height), 1.0, 0.05) << height;
  }
}

TEST_F(CoarseBody, IsAttachedAndPressedWhereTheSceneSays) {
  const Region low = PlaneRegion{{0.0, 0.0, 0.013}, {0.0, 0.0, 1.0}};
  const double exact = 0.04 * 0.04 + 4.0 * 0.04 * 0.013;  // m^2: its base and as much of its sides
  Attachment bed;
  bed.where = {low};
  bed.stiffness_pa_per_m = 1e6;
  tissue_.attachments = {bed};
  tissue_.pressure_pa = 1600.0;
  tissue_.pressure_where = {low};
  const PlacedMesh mesh = placed();
  double stiffness = 0.0;
  for (const NodeSpring& spring : mesh.springs) stiffness += spring.stiffness;
  EXPECT_NEAR(stiffness / (1e6 * exact), 1.0, 0.05);
  EXPECT_NEAR(pressedArea(mesh) / exact, 1.0, 0.05);
}

// The middle of a patch on the surface lies in no element but on its face, by rounding on either side.
TEST_F(CoarseBody, IsPressedOnASmallPatchAnywhere) {
  tissue_.pressure_pa = 1600.0;
  for (int k = 0; k < 200; ++k) {
    const Vector3 middle(0.0001 * (k * 37 % 361) - 0.018, 0.0001 * (k * 53 % 359) - 0.018, 0.06);
    const Vector3 half(0.001, 0.001, 0.0);
    tissue_.pressure_where = {BoxRegion{middle - half, middle + half}};
    EXPECT_NO_THROW(EXPECT_GT(pressedArea(placed()), 0.0)) << middle.transpose();
    tissue_.pressure_where = {SphereRegion{middle, 0.001}};
    EXPECT_NO_THROW(EXPECT_GT(pressedArea(placed()), 0.0)) << middle.transpose();
  }
}

// Labels are of whole elements, which hold their parts and nothing else.
TEST_F(CoarseBody, HasWhatTheFileLabels) {
  std::string data =
      "CELL_DATA " + std::to_string(mesh_.tetrahedra.size()) + "\nSCALARS part int 1\nLOOKUP_TABLE default\n";
  double labelled_m3 = 0.0;
  for (std::size_t e = 0; e < mesh_.tetrahedra.size(); ++e) {
    data += e % 5 == 0 ? "7\n" : "0\n";
    if (e % 5 == 0) labelled_m3 += signedVolume(mesh_.positions, mesh_.tetrahedra[e]);
  }
  write(vtkOf(mesh_) + data);
  addRegion(CellDataRegion{"part", 7.0});
  tissue_.pressure_pa = 1600.0;
  tissue_.pressure_where = {CellDataRegion{"part", 7.0}};
  tissue_.fixed = {PlaneRegion{{0.0, 0.0, 0.007}, {0.0, 0.0, 1.0}}};
  const PlacedMesh refined = placed();
  EXPECT_GT(refined.tetrahedra.size(), 4 * mesh_.tetrahedra.size());
  EXPECT_NEAR(volumeOfRegion(refined), labelled_m3, 1e-12 * labelled_m3);
  const PlacedMesh plain = placeMesh(tissue_, Pose::Identity(), nullptr, {});
  EXPECT_NEAR(pressedArea(refined), pressedArea(plain), 1e-15);
  EXPECT_GT(pressedArea(plain), 0.0);
}

}  // namespace body_edges_test
}  // namespace tissue_contact
