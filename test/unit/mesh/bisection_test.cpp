/// @file
/// Bisection of longest edges: that refined meshes are whole, conforming, nested and of the same shapes; on blocks and on organs
/// that others made.
#include "mesh/bisection.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <limits>
#include <map>
#include <numeric>
#include <set>
#include <string>
#include <vector>

#include "tissue/element_patches.h"

namespace tissue_contact {
namespace bisection_test {

using Place = std::array<double, 3>;

TetMesh cube(int cells) { return makeBlockMesh({Vector3(0.1, 0.1, 0.1), {cells, cells, cells}, {}}, BlockSplit::kSix); }

Bisection bisectionOf(const TetMesh& mesh) {
  return {mesh, patchesByCells(mesh.tetrahedra.size(), static_cast<int>(BlockSplit::kSix))};
}

constexpr std::size_t kMany = 100'000;

/// Fine around a place, m.
EdgeLimit around(const Vector3& place, double finest, double growth) {
  return [=](const Vector3& p) { return finest + growth * (p - place).norm(); };
}

double volumeOf(const TetMesh& mesh) {
  double volume = 0.0;
  for (const Tetrahedron& tet : mesh.tetrahedra) volume += signedVolume(mesh.positions, tet);
  return volume;
}

double longestEdge(const TetMesh& mesh, const Tetrahedron& tet) {
  double longest = 0.0;
  for (std::size_t i = 0; i < 4; ++i) {
    for (std::size_t j = 0; j < i; ++j) {
      longest = std::max(longest, (mesh.positions.col(tet[i]) - mesh.positions.col(tet[j])).norm());
    }
  }
  return longest;
}

/// 1 / (6 sqrt 2) = .118 for a regular one.
double worstShape(const TetMesh& mesh) {
  double worst = 1.0;
  for (const Tetrahedron& tet : mesh.tetrahedra) {
    worst = std::min(worst, signedVolume(mesh.positions, tet) / std::pow(longestEdge(mesh, tet), 3.0));
  }
  return worst;
}

Place placeOf(const NodalVectors& x, int node) { return {x(0, node), x(1, node), x(2, node)}; }

std::set<std::array<Place, 4>> elementsOf(const TetMesh& mesh) {
  std::set<std::array<Place, 4>> elements;
  for (const Tetrahedron& tet : mesh.tetrahedra) {
    std::array<Place, 4> corners;
    for (std::size_t i = 0; i < 4; ++i) corners[i] = placeOf(mesh.positions, tet[i]);
    std::sort(corners.begin(), corners.end());
    elements.insert(corners);
  }
  return elements;
}

/// No node lies within an edge of an element: of every pair of parents no element has both any more.
void expectConforming(const BisectedMesh& refined) {
  std::set<std::array<int, 2>> edges;
  for (const Tetrahedron& tet : refined.mesh.tetrahedra) {
    for (const int a : tet) {
      for (const int b : tet) edges.insert({a, b});
    }
  }
  for (const std::array<int, 2>& parents : refined.parents) EXPECT_EQ(edges.count(parents), 0U);
}

TEST(Bisection, OfACubeFillsItConformsAndKeepsToTheLimit) {
  const TetMesh base = cube(2);
  Bisection bisection = bisectionOf(base);
  const EdgeLimit limit = around({0.02, 0.01, 0.1}, 0.008, 0.5);
  BisectedMesh refined;
  ASSERT_TRUE(bisection.refine(limit, kMany, refined));
  EXPECT_GT(refined.parents.size(), 100U);
  EXPECT_EQ(refined.mesh.positions.leftCols(base.positions.cols()), base.positions);
  EXPECT_NEAR(volumeOf(refined.mesh), 1e-3, 1e-15);
  EXPECT_NO_THROW(checkTetMesh(refined.mesh, "refined"));
  expectConforming(refined);
  double area = 0.0;
  for (const Triangle& t : boundaryTriangles(refined.mesh.tetrahedra)) {
    const Vector3 first = refined.mesh.positions.col(t[1]) - refined.mesh.positions.col(t[0]);
    area += 0.5 * first.cross(refined.mesh.positions.col(t[2]) - refined.mesh.positions.col(t[0])).norm();
  }
  EXPECT_NEAR(area, 0.06, 1e-13);
  for (const Tetrahedron& tet : refined.mesh.tetrahedra) {
    Vector3 centroid = Vector3::Zero();
    for (const int node : tet) centroid += 0.25 * refined.mesh.positions.col(node);
    EXPECT_LE(longestEdge(refined.mesh, tet), (1.0 + 1e-8) * limit(centroid));
  }
}

// Each of its cuts went through all elements at the centre: 186 s of a star of 101 760 tetrahedra.
TEST(Bisection, OfAStarCutsWhatIsAroundAnEdge) {
  constexpr int kRings = 40;
  const auto at = [&](int ring, int i) { return 3 + (ring - 1) * 2 * kRings + i % (2 * kRings); };
  TetMesh star;
  star.positions = NodalVectors::Zero(3, at(kRings - 1, 2 * kRings - 1) + 1);
  star.positions.col(1) = Vector3(0.0, 0.0, 0.05);
  star.positions.col(2) = Vector3(0.0, 0.0, -0.05);
  for (int ring = 1; ring < kRings; ++ring) {
    for (int i = 0; i < 2 * kRings; ++i) {
      const double a = M_PI * ring / kRings;
      const double b = M_PI * i / kRings;
      star.positions.col(at(ring, i)) =
          0.05 * Vector3(std::sin(a) * std::cos(b), std::sin(a) * std::sin(b), std::cos(a));
    }
  }
  for (int i = 0; i < 2 * kRings; ++i) {
    star.tetrahedra.push_back({0, 1, at(1, i), at(1, i + 1)});
    star.tetrahedra.push_back({0, 2, at(kRings - 1, i + 1), at(kRings - 1, i)});
    for (int ring = 1; ring + 1 < kRings; ++ring) {
      star.tetrahedra.push_back({0, at(ring, i), at(ring + 1, i), at(ring, i + 1)});
      star.tetrahedra.push_back({0, at(ring, i + 1), at(ring + 1, i), at(ring + 1, i + 1)});
    }
  }
  checkTetMesh(star, "star");
  Bisection bisection = bisectionOf(star);
  BisectedMesh refined;
  ASSERT_TRUE(bisection.refine([](const Vector3&) { return 0.03; }, kMany, refined));
  EXPECT_NEAR(volumeOf(refined.mesh), volumeOf(star), 1e-15);
  expectConforming(refined);
}

// Three shapes: 1 / (6 sqrt 27) = .0321, 1 / (12 * 2) = .0417 and sqrt(2) / 48 = .0295.
TEST(Bisection, OfCubesHasThreeShapesHoweverDeep) {
  Bisection bisection = bisectionOf(cube(1));
  BisectedMesh refined;
  ASSERT_TRUE(bisection.refine(around({0.05, 0.05, 0.1}, 0.0003, 0.7), kMany, refined));
  EXPECT_GT(refined.parents.size(), 200U);
  EXPECT_NEAR(worstShape(refined.mesh), std::sqrt(2.0) / 48.0, 1e-9);
}

TEST(Bisection, NewNodesLieInTheMiddleBetweenParentsThatComeBeforeThem) {
  Bisection bisection = bisectionOf(cube(2));
  BisectedMesh refined;
  ASSERT_TRUE(bisection.refine(around({0.0, 0.0, 0.1}, 0.01, 0.4), kMany, refined));
  for (std::size_t i = 0; i < refined.parents.size(); ++i) {
    const int node = refined.unrefinedNodes() + static_cast<int>(i);
    const auto [a, b] = refined.parents[i];
    ASSERT_LT(std::max(a, b), node);
    EXPECT_EQ(refined.mesh.positions.col(node), 0.5 * (refined.mesh.positions.col(a) + refined.mesh.positions.col(b)));
  }
}

TEST(Bisection, WithoutAnythingTooLongIsTheMeshItWasGiven) {
  const TetMesh base = cube(2);
  Bisection bisection = bisectionOf(base);
  BisectedMesh refined;
  ASSERT_TRUE(bisection.refine(around({0.02, 0.01, 0.1}, 0.01, 0.5), kMany, refined));
  ASSERT_TRUE(bisection.refine([](const Vector3&) { return 1.0; }, kMany, refined));
  EXPECT_EQ(refined.mesh.positions, base.positions);
  EXPECT_EQ(refined.mesh.tetrahedra, base.tetrahedra);
  EXPECT_TRUE(refined.parents.empty());
}

TEST(Bisection, IsTheSameWhateverCameBefore) {
  Bisection used = bisectionOf(cube(2));
  Bisection fresh = bisectionOf(cube(2));
  BisectedMesh a;
  BisectedMesh b;
  ASSERT_TRUE(used.refine(around({-0.03, 0.0, 0.1}, 0.004, 0.5), kMany, a));
  ASSERT_TRUE(used.refine(around({0.03, 0.0, 0.1}, 0.004, 0.5), kMany, a));
  ASSERT_TRUE(fresh.refine(around({0.03, 0.0, 0.1}, 0.004, 0.5), kMany, b));
  EXPECT_EQ(a.mesh.positions, b.mesh.positions);
  EXPECT_EQ(a.mesh.tetrahedra, b.mesh.tetrahedra);
  EXPECT_EQ(a.patch_of, b.patch_of);
}

// What lets a mesh change away from a contact and stay as it is under it.
TEST(Bisection, TwoPlacesHaveTheSameElementsWhereBothAreFineAndWhereNeitherIs) {
  Bisection bisection = bisectionOf(cube(2));
  BisectedMesh left;
  BisectedMesh right;
  const auto fineWithin = [](double x) {
    return [x](const Vector3& p) { return (p - Vector3(x, 0.0, 0.1)).norm() < 0.03 ? 0.012 : 1.0; };
  };
  ASSERT_TRUE(bisection.refine(fineWithin(-0.005), kMany, left));
  ASSERT_TRUE(bisection.refine(fineWithin(0.005), kMany, right));
  const auto in_left = elementsOf(left.mesh);
  std::size_t common = 0;
  std::size_t within_both = 0;
  for (const std::array<Place, 4>& element : elementsOf(right.mesh)) {
    const bool is_common = in_left.count(element) > 0;
    common += is_common ? 1 : 0;
    const bool near_middle = std::all_of(element.begin(), element.end(),
                                         [](const Place& p) { return Vector3(p[0], p[1], p[2] - 0.1).norm() < 0.015; });
    if (!near_middle) continue;
    ++within_both;
    EXPECT_TRUE(is_common);
  }
  EXPECT_GT(within_both, 20U);
  EXPECT_GT(common, in_left.size() / 2);
}

TEST(Bisection, EndsWhereItMayHaveNoMoreNodes) {
  Bisection bisection = bisectionOf(cube(2));
  BisectedMesh refined;
  ASSERT_TRUE(bisection.refine([](const Vector3&) { return 1.0; }, kMany, refined));
  const EdgeLimit everywhere = [](const Vector3&) { return 1e-9; };
  EXPECT_FALSE(bisection.refine(everywhere, 500, refined));
  EXPECT_EQ(refined.mesh.positions.cols(), 27) << "as it was";
  ASSERT_TRUE(bisection.refine([](const Vector3&) { return 0.05; }, 500, refined));
  EXPECT_LE(refined.mesh.positions.cols(), 500);
}

TEST(Bisection, LastingCutsComeFirstInEveryMesh) {
  Bisection bisection = bisectionOf(cube(2));
  const auto below = [](double height) {
    return [height](const ElementPart& part) {
      const bool any =
          std::any_of(part.corners.begin(), part.corners.end(), [&](const Vector3& x) { return x.z() < height; });
      return any ? 0.02 : 1.0;
    };
  };
  EXPECT_FALSE(bisection.refineLasting(below(0.1), 30));
  BisectedMesh untouched;
  ASSERT_TRUE(bisection.refine([](const Vector3&) { return 1.0; }, kMany, untouched));
  EXPECT_TRUE(untouched.parents.empty()) << "what did not fit left nothing";
  ASSERT_TRUE(bisection.refineLasting(below(0.02), kMany));
  ASSERT_TRUE(bisection.refine([](const Vector3&) { return 1.0; }, kMany, untouched));
  EXPECT_GT(untouched.lasting, 50);
  EXPECT_EQ(untouched.parents.size(), static_cast<std::size_t>(untouched.lasting));
  int uncut = 0;
  for (const Tetrahedron& tet : untouched.mesh.tetrahedra) {
    double lowest = 1.0;
    for (const int node : tet) lowest = std::min(lowest, untouched.mesh.positions(2, node));
    if (longestEdge(untouched.mesh, tet) > 0.04) ++uncut;
    if (lowest < 0.0199) {
      EXPECT_LE(longestEdge(untouched.mesh, tet), 0.02 * (1.0 + 1e-8));
    }
  }
  EXPECT_GT(uncut, 10) << "far from what is to be cut";
  BisectedMesh refined;
  ASSERT_TRUE(bisection.refine(around({0.02, 0.01, 0.1}, 0.008, 0.5), kMany, refined));
  EXPECT_EQ(refined.lasting, untouched.lasting);
  EXPECT_GT(refined.parents.size(), untouched.parents.size() + 100U);
  EXPECT_EQ(refined.mesh.positions.leftCols(untouched.mesh.positions.cols()), untouched.mesh.positions);
  EXPECT_NEAR(volumeOf(refined.mesh), 1e-3, 1e-15);
  expectConforming(refined);
}

TEST(Bisection, PatchesAreOfAFewElements) {
  Bisection bisection = bisectionOf(cube(2));
  BisectedMesh refined;
  ASSERT_TRUE(bisection.refine(around({0.02, 0.01, 0.1}, 0.004, 0.5), kMany, refined));
  ASSERT_EQ(refined.patch_of.size(), refined.mesh.tetrahedra.size());
  std::map<int, std::vector<Tetrahedron>> patches;
  for (std::size_t e = 0; e < refined.patch_of.size(); ++e) {
    patches[refined.patch_of[e]].push_back(refined.mesh.tetrahedra[e]);
  }
  EXPECT_EQ(patches.begin()->first, 0);
  EXPECT_EQ(patches.rbegin()->first, static_cast<int>(patches.size()) - 1);
  std::size_t small = 0;
  for (const auto& [number, patch] : patches) {
    EXPECT_LE(patch.size(), 12U);
    small += patch.size() < 3 ? 1 : 0;
  }
  EXPECT_LT(small, patches.size() / 20) << "one or two tetrahedra are stiff on their own";
}

TEST(Bisection, OfAGradedBlockIsWhole) {
  BlockDescription block{Vector3(0.1, 0.06, 0.04), {5, 3, 4}, {}};
  block.grading[2] = {1.5, AxisGrading::FineAt::kMaximum};
  const TetMesh base = makeBlockMesh(block, BlockSplit::kSix);
  Bisection bisection = bisectionOf(base);
  BisectedMesh refined;
  ASSERT_TRUE(bisection.refine(around({0.02, 0.01, 0.04}, 0.004, 0.5), kMany, refined));
  EXPECT_NEAR(volumeOf(refined.mesh), 2.4e-4, 1e-16);
  EXPECT_NO_THROW(checkTetMesh(refined.mesh, "refined"));
  expectConforming(refined);
  EXPECT_GT(worstShape(refined.mesh), 0.5 * worstShape(base));
}

TEST(Bisection, OfOrgansThatOthersMeshedIsWholeAndNotMuchWorse) {
  const std::string folder = std::string(TISSUE_CONTACT_SHARED_DATA) + "/organs/";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "no organs in " << folder;
  for (const char* const name : {"liver_volumetric.vtk", "gallbladder_volumetric.vtk", "tissue_volume.msh"}) {
    MeshDescription file;
    file.file = folder + name;
    file.remove_unreferenced_nodes = true;
    const TetMesh base = loadTetMesh(file);
    Bisection bisection(base, patchesByFaces(base.positions, base.tetrahedra));
    const Vector3 place = base.positions.col(base.positions.cols() / 2);
    const double size = (base.positions.rowwise().maxCoeff() - base.positions.rowwise().minCoeff()).norm();
    BisectedMesh refined;
    ASSERT_TRUE(bisection.refine(around(place, 0.01 * size, 0.5), kMany, refined)) << name;
    EXPECT_GT(refined.parents.size(), 100U) << name;
    EXPECT_NEAR(volumeOf(refined.mesh), volumeOf(base), 1e-12 * std::abs(volumeOf(base))) << name;
    EXPECT_NO_THROW(checkTetMesh(refined.mesh, name));
    expectConforming(refined);
    EXPECT_GT(worstShape(refined.mesh), 0.2 * worstShape(base)) << name;
  }
}

}  // namespace bisection_test
}  // namespace tissue_contact
