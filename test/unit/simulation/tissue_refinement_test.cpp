/// @file
/// TissueRefinement: when a mesh changes, that it keeps to its nodes, and what goes over from mesh to mesh.
#include "simulation/tissue_refinement.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <fstream>
#include <optional>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "support/refusal.h"
#include "support/temporary_directory.h"
#include "tissue_contact/mesh/tet_mesh.h"
#include "tissue_contact/mesh/triangle_mesh.h"

namespace tissue_contact {
namespace tissue_refinement_test {

TissueDescription block(const RefinementDescription& refinement = {RefinementDescription::Mode::kAuto, 0.0, 0.0, 0}) {
  TissueDescription description;
  description.name = "block";
  description.geometry = BlockDescription{Vector3(0.1, 0.1, 0.04), {10, 10, 4}, {}};
  description.material.youngs_modulus_pa = 5000.0;
  description.material.poissons_ratio = 0.45;
  description.material.density_kg_per_m3 = 1000.0;
  description.fixed = {PlaneRegion{Vector3::Zero(), Vector3::UnitZ()}};
  description.refinement = refinement;
  return description;
}

Pose somewhere() {
  Pose X_WT = Pose::Identity();
  X_WT.translate(Vector3(0.3, -0.2, 0.1));
  X_WT.rotate(Eigen::AngleAxisd(0.4, Vector3(1.0, 2.0, 3.0).normalized()));
  return X_WT;
}

/// On the upper face.
FinePlace at(double x, double y, double cell_m = 0.00125) { return {Vector3(x, y, 0.04), cell_m}; }

/// Refines the mesh around the places if one of them is not well within what is fine. @return how nodes went over to another mesh.
std::optional<NodeTransfer> follow(TissueRefinement& refinement, const std::vector<FinePlace>& places) {
  const auto is_covered = [&](const FinePlace& place) {
    return refinement.cells().isCovered(place, FineCells::kCovered);
  };
  if (std::all_of(places.begin(), places.end(), is_covered)) return std::nullopt;
  NextMesh next = refinement.plan(places);
  refinement.take(next);
  return next.transfer;
}

TEST(FineCells, GrowAsTheRefinementSays) {
  using Mode = RefinementDescription::Mode;
  constexpr double kCell = 0.00125;
  const std::tuple<RefinementDescription, double, double> refinements[] = {
      {{Mode::kAuto}, 2.0 * kCell, 0.35},
      {{Mode::kFine}, 3.0 * kCell, 0.2},
      {{Mode::kGiven, kCell}, 2.0 * kCell, 0.35},
      {{Mode::kGiven, kCell, 0.004, 0, 0.3}, 0.004, 0.3}};
  for (const auto& [refinement, reach_m, growth] : refinements) {
    FineCells cells(refinement);
    cells.add({{Vector3::Zero(), kCell}});
    EXPECT_EQ(cells.reach(kCell), reach_m);
    EXPECT_EQ(cells.longestEdge(Vector3(reach_m, 0.0, 0.0)), std::sqrt(3.0) * kCell);
    const Vector3 beyond(reach_m + 0.005, 0.0, 0.0);
    EXPECT_NEAR(cells.longestEdge(beyond), std::sqrt(3.0) * (kCell + growth * 0.005), 1e-15) << growth;
  }
}

TEST(TissueRefinement, FineMayHaveMoreNodes) {
  using Mode = RefinementDescription::Mode;
  const auto nodesAtMost = [](const RefinementDescription& refinement) { return mostNodes(refinement, 605); };
  EXPECT_EQ(nodesAtMost({Mode::kAuto}), 2605U);
  EXPECT_EQ(nodesAtMost({Mode::kFine}), 20605U);
  EXPECT_EQ(mostNodes({Mode::kAuto}, 8000), 12000U);
  EXPECT_EQ(nodesAtMost({Mode::kFine, 0.0, 0.0, 700}), 700U);
}

/// `count` by `count` places.
std::vector<FinePlace> patch(int count, double spacing_m, double first_m, double cell_m) {
  std::vector<FinePlace> places;
  places.reserve(static_cast<std::size_t>(count) * static_cast<std::size_t>(count));
  for (int row = 0; row < count; ++row) {
    for (int column = 0; column < count; ++column) {
      places.push_back(at(first_m + spacing_m * column, first_m + spacing_m * row, cell_m));
    }
  }
  return places;
}

TEST(TissueRefinement, BeginsUnrefined) {
  const TissueDescription description = block();
  const TissueRefinement refinement(description, somewhere(), nullptr);
  EXPECT_EQ(refinement.tissue().nodeCount(), 605);
  EXPECT_EQ(refinement.tissue().tetrahedra().size(), 2400U);
  EXPECT_EQ(refinement.revision(), 0);
}

TEST(TissueRefinement, RefinesWhereTouchedAndStaysWhileThatIsWellWithin) {
  const TissueDescription description = block();
  TissueRefinement refinement(description, somewhere(), nullptr);
  EXPECT_FALSE(follow(refinement, {}));
  ASSERT_TRUE(follow(refinement, {at(0.0, 0.0)}));
  EXPECT_EQ(refinement.revision(), 1);
  const int nodes = refinement.tissue().nodeCount();
  EXPECT_GT(nodes, 700);
  EXPECT_LT(nodes, 1500);
  for (const double x : {0.0, 0.0005, 0.001, -0.001}) EXPECT_FALSE(follow(refinement, {at(x, 0.0)})) << x;
  EXPECT_FALSE(follow(refinement, {})) << "nothing touches: it may come back";
  EXPECT_TRUE(follow(refinement, {at(0.004, 0.0)}));
  EXPECT_EQ(refinement.revision(), 2);
}

TEST(TissueRefinement, FindsTheSameMeshAgainOnTheWayBack) {
  const TissueDescription description = block();
  TissueRefinement refinement(description, somewhere(), nullptr);
  follow(refinement, {at(0.01, 0.003)});
  const NodalVectors first = refinement.tissue().restPositions();
  follow(refinement, {at(-0.02, 0.003)});
  // Eigen compares matrices of one size only.
  const NodalVectors other = refinement.tissue().restPositions();
  EXPECT_TRUE(other.cols() != first.cols() || other != first);
  follow(refinement, {at(0.01, 0.003)});
  ASSERT_EQ(refinement.tissue().restPositions().cols(), first.cols());
  EXPECT_EQ(refinement.tissue().restPositions(), first);
}

TEST(TissueRefinement, SeveralPlacesMergeAndPart) {
  const TissueDescription description = block();
  TissueRefinement refinement(description, somewhere(), nullptr);
  follow(refinement, {at(0.0, 0.0)});
  const int one = refinement.tissue().nodeCount();
  follow(refinement, {at(-0.03, 0.0), at(0.03, 0.0)});
  const int apart = refinement.tissue().nodeCount();
  follow(refinement, {at(-0.002, 0.02), at(0.002, 0.02)});
  const int together = refinement.tissue().nodeCount();
  EXPECT_GT(apart, 605 + 3 * (one - 605) / 2);
  EXPECT_LT(together, apart);
}

TEST(TissueRefinement, CellsGrowUntilThereAreNoMoreNodesThanAllowed) {
  const TissueDescription description = block({RefinementDescription::Mode::kGiven, 0.0002, 0.0, 900});
  TissueRefinement refinement(description, somewhere(), nullptr);
  ASSERT_TRUE(follow(refinement, {at(0.0, 0.0, 0.0002)}));
  EXPECT_LE(refinement.tissue().nodeCount(), 900);
  EXPECT_GT(refinement.tissue().nodeCount(), 700);
  EXPECT_GT(refinement.cells().coarsening(), 2.0);
}

TEST(TissueRefinement, CellsOfAMicrometreGrowAsWell) {
  const TissueDescription description = block({RefinementDescription::Mode::kGiven, 1e-6, 0.0, 900});
  TissueRefinement refinement(description, somewhere(), nullptr);
  const std::vector<FinePlace> places = patch(20, 0.0002, 0.0, 1e-6);
  ASSERT_TRUE(follow(refinement, places));
  EXPECT_LE(refinement.tissue().nodeCount(), 900);
  EXPECT_GT(refinement.tissue().nodeCount(), 650);
  EXPECT_FALSE(follow(refinement, places)) << "they are covered by cells as long as they had to be";
}

TEST(TissueRefinement, WithFewerNodesAllowedThanThereAreNothingIsRefined) {
  const TissueDescription description = block({RefinementDescription::Mode::kGiven, 0.001, 0.0, 100});
  TissueRefinement refinement(description, somewhere(), nullptr);
  EXPECT_FALSE(follow(refinement, {at(0.0, 0.0, 0.001)}));
  EXPECT_EQ(refinement.tissue().nodeCount(), 605);
  EXPECT_EQ(refinement.revision(), 0);
}

TEST(TissueRefinement, CarriesNodesAndLinearFieldsFromMeshToMesh) {
  const TissueDescription description = block();
  TissueRefinement refinement(description, somewhere(), nullptr);
  const Matrix3 gradient = (Matrix3() << 1.1, 0.2, 0.0, 0.1, 0.9, -0.3, 0.2, 0.1, 1.2).finished();
  NodalVectors field = gradient * refinement.tissue().restPositions();
  for (const double x : {0.0, 0.006, 0.03, -0.04}) {
    const NodalVectors before = field;
    const auto transfer = follow(refinement, {at(x, 0.5 * x)});
    ASSERT_TRUE(transfer) << x;
    field = transfer->carried(before);
    const NodalVectors rest = refinement.tissue().restPositions();
    ASSERT_EQ(field.cols(), rest.cols());
    EXPECT_LT((field - gradient * rest).cwiseAbs().maxCoeff(), 1e-15);
    for (std::size_t old = 0; old < transfer->to_new.size(); ++old) {
      const int now = transfer->to_new[old];
      if (now < 0) continue;
      EXPECT_EQ(transfer->from_old[now], static_cast<int>(old));
      EXPECT_EQ(field.col(now), before.col(static_cast<Eigen::Index>(old)));
    }
    EXPECT_EQ(transfer->to_new[604], 604) << "nodes of the unrefined mesh come first and stay";
  }
}

TEST(TissueRefinement, GoesBackToTheUnrefinedMesh) {
  const TissueDescription description = block();
  TissueRefinement refinement(description, somewhere(), nullptr);
  EXPECT_FALSE(refinement.reset());
  follow(refinement, {at(0.0, 0.0)});
  EXPECT_TRUE(refinement.reset());
  EXPECT_EQ(refinement.tissue().nodeCount(), 605);
  EXPECT_EQ(refinement.revision(), 2) << "never less, so that nobody takes this mesh for the one before";
  EXPECT_TRUE(follow(refinement, {at(0.0, 0.0)}));
}

/// The centroid of an element, or surface triangle, near to the upper face's middle.
template <std::size_t N>
Vector3 centroidNear(const NodalVectors& x, const std::vector<std::array<int, N>>& elements) {
  Vector3 nearest = Vector3::Zero();
  for (const std::array<int, N>& element : elements) {
    Vector3 middle = Vector3::Zero();
    for (const int node : element) middle += x.col(node) / N;
    if ((middle - Vector3(0, 0, 0.04)).norm() < (nearest - Vector3(0, 0, 0.04)).norm()) nearest = middle;
  }
  return nearest;
}

// Places that hold one element, one triangle: by centroids of the parts they would hold none. Else bodies would change with their meshes: a
// stone in fat that grew as elements around it shrank made half of the work done from nothing.
TEST(TissueRefinement, RegionsAttachmentsAndPressureStayWhatTheyWere) {
  const TetMesh mesh = makeBlockMesh({Vector3(0.1, 0.1, 0.04), {10, 10, 4}, {}}, BlockSplit::kSix);
  const SphereRegion in_element{centroidNear(mesh.positions, mesh.tetrahedra), 0.0001};
  const SphereRegion on_surface{centroidNear(mesh.positions, boundaryTriangles(mesh.tetrahedra)), 0.0001};
  TissueDescription description = block();
  description.regions.resize(1);
  description.regions[0].name = "nodule";
  description.regions[0].where = {in_element, SphereRegion{Vector3(0.03, 0.03, 0.03), 0.02}};
  description.regions[0].material = description.material;
  description.regions[0].material.youngs_modulus_pa = 20000.0;
  description.regions[0].material.density_kg_per_m3 = 2000.0;
  description.attachments = {{{on_surface}, 1e6, 0.0}};
  description.pressure_pa = 100.0;
  description.pressure_where = {on_surface};
  TissueRefinement refinement(description, Pose::Identity(), nullptr);
  struct Sums {
    double nodule_m3 = 0.0, mass_kg = 0.0, springs_n_per_m = 0.0, area_m2 = 0.0;
    Vector3 nodule_m4 = Vector3::Zero(), area_m3 = Vector3::Zero();  // first moments: where they are
    Vector3 pressure_n = Vector3::Zero(), pressure_nm = Vector3::Zero();
  };
  const auto sums = [&] {
    const Tissue tissue = refinement.tissue();
    Sums all;
    for (std::size_t e = 0; e < tissue.tetrahedra().size(); ++e) {
      if (tissue.elementRegions()[e] != 0) continue;
      const double volume = signedVolume(tissue.restPositions(), tissue.tetrahedra()[e]);
      all.nodule_m3 += volume;
      for (const int node : tissue.tetrahedra()[e]) all.nodule_m4 += 0.25 * volume * tissue.restPositions().col(node);
    }
    for (std::size_t t = 0; t < tissue.surface().size(); ++t) {
      if (tissue.surfaceRegions()[t] != 0) continue;
      const double area = triangleArea(tissue.restPositions(), tissue.surface()[t]);
      all.area_m2 += area;
      for (const int node : tissue.surface()[t]) all.area_m3 += area / 3.0 * tissue.restPositions().col(node);
    }
    all.mass_kg = tissue.nodeMasses().sum();
    all.springs_n_per_m = tissue.attachmentStiffness();
    NodalVectors forces = NodalVectors::Zero(3, tissue.nodeCount());
    tissue.addPressure(tissue.restPositions(), forces);
    all.pressure_n = forces.rowwise().sum();
    for (int i = 0; i < tissue.nodeCount(); ++i) {
      all.pressure_nm += Vector3(tissue.restPositions().col(i)).cross(Vector3(forces.col(i)));
    }
    return all;
  };
  const Sums before = sums();
  EXPECT_GT(before.nodule_m3, 0.0);
  EXPECT_GT(before.area_m2, 0.0);
  EXPECT_GT(before.pressure_n.norm(), 0.0);
  ASSERT_TRUE(follow(refinement, {{Vector3(0.0, 0.0, 0.04), 0.001}, {Vector3(0.02, 0.02, 0.04), 0.002}}));
  const Sums after = sums();
  EXPECT_NEAR(after.nodule_m3, before.nodule_m3, 1e-12 * before.nodule_m3);
  EXPECT_NEAR(after.area_m2, before.area_m2, 1e-12 * before.area_m2);
  EXPECT_NEAR(after.mass_kg, before.mass_kg, 1e-12 * before.mass_kg);
  EXPECT_NEAR(after.springs_n_per_m, before.springs_n_per_m, 1e-12 * before.springs_n_per_m);
  EXPECT_LT((after.nodule_m4 - before.nodule_m4).norm(), 1e-12 * before.nodule_m4.norm());
  EXPECT_LT((after.area_m3 - before.area_m3).norm(), 1e-12 * before.area_m3.norm());
  EXPECT_LT((after.pressure_n - before.pressure_n).norm(), 1e-12 * before.pressure_n.norm());
  EXPECT_LT((after.pressure_nm - before.pressure_nm).norm(), 1e-12 * before.pressure_nm.norm());
}

// The ball holds one node of the block's cells of 10 mm. From the start on it is held as the ball that it is, and what comes later
// between two nodes that move is not held back.
TEST(TissueRefinement, HoldsWhatFixedSaysFromTheStartAndNoNodeBetweenOnesThatMove) {
  TissueDescription description = block();
  const SphereRegion ball{Vector3(0.0, 0.0, 0.04), 0.008};
  description.fixed = {ball};
  TissueRefinement refinement(description, Pose::Identity(), nullptr);
  const auto isWithin = [&](const Tissue& tissue, int node) {
    return (tissue.restPositions().col(node) - ball.center_m).norm() <= ball.radius_m;
  };
  const Tissue before = refinement.tissue();
  int held = 0;
  for (int i = 0; i < before.nodeCount(); ++i) {
    held += before.fixed()[static_cast<std::size_t>(i)] ? 1 : 0;
    EXPECT_EQ(before.fixed()[static_cast<std::size_t>(i)], isWithin(before, i)) << i;
  }
  EXPECT_GT(held, 3);
  EXPECT_EQ(refinement.revision(), 0);
  EXPECT_FALSE(refinement.reset()) << "it is the mesh that nothing touches";
  const auto transfer = follow(refinement, {{Vector3(0.008, 0, 0.04), 0.00125}});
  ASSERT_TRUE(transfer);
  const Tissue after = refinement.tissue();
  int let_go = 0;
  for (int i = 0; i < after.nodeCount(); ++i) {
    const auto node = static_cast<std::size_t>(i);
    if (transfer->from_old[node] >= 0) {
      EXPECT_EQ(after.fixed()[node], before.fixed()[static_cast<std::size_t>(transfer->from_old[node])]) << i;
      continue;
    }
    const auto [a, b] = refinement.mesh().parents[node - static_cast<std::size_t>(refinement.mesh().unrefinedNodes())];
    EXPECT_EQ(after.fixed()[node], after.fixed()[a] && after.fixed()[b]) << i;
    if (!after.fixed()[node] && isWithin(after, i)) ++let_go;
  }
  EXPECT_GT(let_go, 0);
  EXPECT_TRUE(refinement.reset());
  EXPECT_EQ(refinement.tissue().restPositions(), before.restPositions());
}

// Two lips of a slit have nodes at one place, which are not the same.
TEST(TissueRefinement, KeepsNodesApartThatLieAtOnePlace) {
  const TemporaryDirectory folder;
  const std::string file = (folder.path() / "slit.msh").string();
  std::ofstream(file) << "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n8\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n"
                         "5 0 0 0\n6 1 0 0\n7 0 1 0\n8 0 0 -1\n$EndNodes\n$Elements\n2\n1 4 2 1 1 1 2 3 4\n"
                         "2 4 2 1 1 5 7 6 8\n$EndElements\n";
  TissueDescription description = block();
  MeshDescription mesh;
  mesh.file = file;
  mesh.coincident_nodes = CoincidentNodes::kKeep;
  description.geometry = mesh;
  description.fixed.clear();
  TissueRefinement refinement(description, Pose::Identity(), nullptr);
  for (const double x : {0.1, 0.6}) {
    const auto transfer = follow(refinement, {{Vector3(x, 0.1, 0.0), 0.1}});
    ASSERT_TRUE(transfer);
    for (int node = 0; node < 8; ++node) EXPECT_EQ(transfer->to_new[node], node);
    for (std::size_t old = 0; old < transfer->to_new.size(); ++old) {
      if (transfer->to_new[old] >= 0) {
        EXPECT_EQ(transfer->from_old[transfer->to_new[old]], static_cast<int>(old));
      }
    }
  }
}

TEST(TissueRefinement, WhereNodesRunOutAllCellsBecomeAlike) {
  const TissueDescription description = block({RefinementDescription::Mode::kGiven, 0.0015, 0.0, 1100});
  TissueRefinement refinement(description, somewhere(), nullptr);
  ASSERT_TRUE(follow(refinement, {at(0.0, 0.0, 0.0015)}));
  ASSERT_TRUE(follow(refinement, patch(5, 0.002, -0.004, 0.0015)));
  EXPECT_LT(refinement.cells().coarsening(), 3.0) << "not the unrefined mesh beside a fine one";
  EXPECT_LE(refinement.tissue().nodeCount(), 1100);
}

TEST(TissueRefinement, IsRefusedWhereMeshesCannotChange) {
  const auto refused = [](TissueDescription description) { return refusal([&] { checkTissue(description); }); };
  TissueDescription sheet = block();
  sheet.geometry = SheetDescription{Vector2(0.1, 0.1), {4, 4}, 0.001};
  sheet.material.model = ElasticModel::kMembrane;
  expectContains(refused(sheet), {"tissue 'block'", "refinement", "sheet or shell", "never"});
  TissueDescription springs = block();
  springs.material.model = ElasticModel::kMassSpring;
  expectContains(refused(springs), {"mass-spring", "edges"});
  TissueDescription relaxing = block();
  relaxing.material.prony_series = {{0.5, 0.1}};
  expectContains(refused(relaxing), {"relaxes"});
  TissueDescription attached = block();
  attached.attachments = {{{SphereRegion{Vector3::Zero(), 0.01}}, 0.0, 20.0}};
  expectContains(refused(attached), {"stiffness_n_per_m", "give stiffness_pa_per_m"});
}

}  // namespace tissue_refinement_test
}  // namespace tissue_contact
