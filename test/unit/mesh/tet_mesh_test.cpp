/// @file
/// checkTetMesh, signedVolume, boundaryTriangles, fixedNodes and bordersIn on small meshes made by hand.
#include "tissue_contact/mesh/tet_mesh.h"

#include <gtest/gtest.h>

#include <array>
#include <limits>
#include <string>
#include <vector>

#include "mesh/region.h"
#include "mesh_writers.h"

namespace tissue_contact {
namespace tet_mesh_test {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

void expectRefused(const TetMesh& mesh, const std::vector<std::string>& words) {
  expectRefusal([&] { checkTetMesh(mesh, "tissue 'liver'"); }, words);
}

TEST(CheckTetMesh, AcceptsAGoodMeshInAnyUnit) {
  // No absolute threshold: cells of a nanometre are as good as cells of a kilometre.
  for (const double scale : {1e-30, 1e-9, 1.0, 1e3, 1e100}) {
    TetMesh mesh = twoTetrahedra();
    mesh.positions *= scale;
    EXPECT_NO_THROW(checkTetMesh(mesh, "mesh")) << scale;
  }
}

TEST(CheckTetMesh, RefusesAnEmptyMesh) {
  expectRefused(TetMesh{}, {"tissue 'liver': ", "no tetrahedra"});
  TetMesh mesh = twoTetrahedra();
  mesh.tetrahedra.clear();
  expectRefused(mesh, {"no tetrahedra"});
}

TEST(CheckTetMesh, NamesTheNodeThatIsNotFinite) {
  for (const double bad : {kNan, kInfinity, -kInfinity}) {
    for (int axis = 0; axis < 3; ++axis) {
      TetMesh mesh = twoTetrahedra();
      mesh.positions(axis, 3) = bad;
      expectRefused(mesh, {"tissue 'liver': node 3 ", "finite"});
    }
  }
}

TEST(CheckTetMesh, NamesTheElementWithAnIndexOutOfRange) {
  for (const int bad : {-1, 5, std::numeric_limits<int>::max(), std::numeric_limits<int>::min()}) {
    TetMesh mesh = twoTetrahedra();
    mesh.tetrahedra[1][2] = bad;
    expectRefused(mesh, {"tetrahedron 1 ", std::to_string(bad), "5 nodes"});
  }
}

TEST(CheckTetMesh, NamesTheInvertedElementInAnyUnit) {
  for (const double scale : {1e-9, 1.0, 1e3}) {
    TetMesh mesh = twoTetrahedra();
    mesh.positions *= scale;
    std::swap(mesh.tetrahedra[1][0], mesh.tetrahedra[1][1]);
    expectRefused(mesh, {"tetrahedron 1 (nodes 2, 1, 3, 4) is inverted"});
  }
}

TEST(CheckTetMesh, NamesTheElementWithoutVolume) {
  TetMesh flat = twoTetrahedra();
  flat.positions.col(4) = (flat.positions.col(1) + flat.positions.col(2) + flat.positions.col(3)) / 3.0;
  expectRefused(flat, {"tetrahedron 1 ", "no volume"});
  TetMesh repeated = twoTetrahedra();
  repeated.tetrahedra[1][3] = 2;
  expectRefused(repeated, {"tetrahedron 1 (nodes 1, 2, 3, 2) has no volume"});
  TetMesh point = twoTetrahedra();
  point.positions.setZero();
  expectRefused(point, {"tetrahedron 0 ", "no volume"});
}

TEST(CheckTetMesh, JudgesVolumeByTheLongestEdge) {
  // Height h over a base of longest edge sqrt(2) and area 1/2: volume h / 6, limit 1e-12 * 2^1.5.
  const double limit = 6.0 * 1e-12 * std::pow(2.0, 1.5);
  for (const double scale : {1e-6, 1.0, 1e6}) {
    TetMesh mesh = twoTetrahedra();
    mesh.positions(2, 3) = 1.01 * limit;
    mesh.tetrahedra.pop_back();
    mesh.positions.conservativeResize(3, 4);
    mesh.positions *= scale;
    EXPECT_NO_THROW(checkTetMesh(mesh, "mesh")) << scale;
    mesh.positions(2, 3) *= 0.99 / 1.01;
    expectRefused(mesh, {"tetrahedron 0 ", "no volume"});
    mesh.positions(2, 3) *= -1.0;
    expectRefused(mesh, {"tetrahedron 0 ", "no volume"});
    mesh.positions(2, 3) *= 1.01 / 0.99;
    expectRefused(mesh, {"tetrahedron 0 ", "inverted"});
  }
}

TEST(CheckTetMesh, NamesTwoElementsOnTheSameNodes) {
  TetMesh mesh = twoTetrahedra();
  mesh.tetrahedra.push_back({2, 3, 1, 4});  // an even permutation of element 1: positive volume
  expectRefused(mesh, {"tetrahedron 2 has the same four nodes as tetrahedron 1"});
}

TEST(CheckTetMesh, NamesTheNodeThatNoElementUsesAndTheFix) {
  TetMesh mesh = twoTetrahedra();
  mesh.positions.conservativeResize(3, 7);
  mesh.positions.col(6) = mesh.positions.col(4);
  mesh.positions.col(5) = mesh.positions.col(4);
  expectRefused(mesh, {"node 5 belongs to no tetrahedron (2 such", "`remove_unreferenced_nodes: true`"});
}

TEST(SignedVolume, ChangesSignWithOrientation) {
  const TetMesh mesh = twoTetrahedra();
  EXPECT_DOUBLE_EQ(signedVolume(mesh.positions, {0, 1, 2, 3}), 1.0 / 6.0);
  EXPECT_DOUBLE_EQ(signedVolume(mesh.positions, {1, 0, 2, 3}), -1.0 / 6.0);
  EXPECT_DOUBLE_EQ(signedVolume(mesh.positions, {1, 2, 3, 4}), 1.0 / 3.0);
}

TEST(BoundaryTriangles, AreOutwardAndInTheOrderOfTheElements) {
  const TetMesh mesh = twoTetrahedra();
  const std::vector<Triangle> surface = boundaryTriangles(mesh.tetrahedra);
  ASSERT_EQ(surface.size(), 6U);  // 8 faces but for the shared one
  const Vector3 centers[] = {Vector3::Constant(0.25), Vector3::Constant(0.5)};
  for (std::size_t i = 0; i < surface.size(); ++i) {
    const Vector3 a = mesh.positions.col(surface[i][0]);
    const Vector3 b = mesh.positions.col(surface[i][1]);
    const Vector3 c = mesh.positions.col(surface[i][2]);
    const std::size_t element = i < 3 ? 0 : 1;  // the first three belong to element 0, the others to 1
    EXPECT_GT((b - a).cross(c - a).dot(a - centers[element]), 0.0) << "triangle " << i;
  }
  EXPECT_EQ(surface, boundaryTriangles(mesh.tetrahedra));
}

TEST(BoundaryTriangles, RefusesAFaceOfThreeElements) {
  std::vector<Tetrahedron> tetrahedra = twoTetrahedra().tetrahedra;
  tetrahedra.push_back({1, 2, 3, 5});
  expectRefusal([&] { boundaryTriangles(tetrahedra); }, {"nodes 1, 2, 3 belongs to 3 tetrahedra", "0, 1 and 2"});
}

TEST(BoundaryTriangles, OfNothingIsNothing) { EXPECT_TRUE(boundaryTriangles({}).empty()); }

std::vector<bool> fixedOf(const std::vector<Region>& regions) {
  return fixedNodes(twoTetrahedra().positions, regions, "tissue 'liver'");
}

TEST(FixedNodes, HoldsTheNodesOfEachKindOfRegion) {
  EXPECT_EQ(fixedOf({}), std::vector<bool>(5, false));
  EXPECT_EQ(fixedOf({BoxRegion{{-1, -1, -1}, {1, 1, 0}}}), (std::vector<bool>{true, true, true, false, false}));
  EXPECT_EQ(fixedOf({PlaneRegion{{0, 0, 0}, {0, 0, 1}}}), (std::vector<bool>{true, true, true, false, false}));
  EXPECT_EQ(fixedOf({PlaneRegion{{0, 0, 1}, {0, 0, -1}}}), (std::vector<bool>{false, false, false, true, true}));
  EXPECT_EQ(fixedOf({PlaneRegion{{0, 0, 0.5}, {0, 0, 7}}}), (std::vector<bool>{true, true, true, false, false}));
  EXPECT_EQ(fixedOf({SphereRegion{{0, 0, 0}, 1.0}}), (std::vector<bool>{true, true, true, true, false}));
  EXPECT_EQ(fixedOf({BoxRegion{{-kInfinity, -kInfinity, 1}, {kInfinity, kInfinity, kInfinity}}}),
            (std::vector<bool>{false, false, false, true, true}));
}

TEST(FixedNodes, IsTheUnionOfTheRegions) {
  EXPECT_EQ(fixedOf({SphereRegion{{0, 0, 0}, 0.1}, SphereRegion{{1, 1, 1}, 0.1}}),
            (std::vector<bool>{true, false, false, false, true}));
}

TEST(FixedNodes, CountsANodeOnTheBoundaryDespiteRounding) {
  NodalVectors x(3, 2);
  x << 0.1 * 3, 1.0, 0.0, 0.0, 0.0, 0.0;  // 0.1 * 3 is one bit above 0.3
  ASSERT_GT(x(0, 0), 0.3);
  const std::vector<bool> expected = {true, false};
  EXPECT_EQ(fixedNodes(x, {BoxRegion{{0, 0, 0}, {0.3, 0, 0}}}, "mesh"), expected);
  EXPECT_EQ(fixedNodes(x, {PlaneRegion{{0.3, 0, 0}, {2, 0, 0}}}, "mesh"), expected);
  EXPECT_EQ(fixedNodes(x, {SphereRegion{{0, 0, 0}, 0.3}}, "mesh"), expected);
}

TEST(Region, HasABorderInATetrahedronThatItCutsAndNotInOneThatItTouches) {
  const std::array<Vector3, 4> corners = {Vector3(0, 0, 0), Vector3(1, 0, 0), Vector3(0, 1, 0), Vector3(0, 0, 1)};
  const auto below = [](double height) { return PlaneRegion{{0, 0, height}, {0, 0, 1}}; };
  for (const double height : {0.2, 0.5, 0.9}) EXPECT_TRUE(bordersIn({below(height)}, corners, 1e-9)) << height;
  for (const double height : {-0.1, 0.0, 0.1, 1.0}) EXPECT_FALSE(bordersIn({below(height)}, corners, 1e-9)) << height;
  EXPECT_TRUE(bordersIn({SphereRegion{{0, 0, 1}, 0.2}}, corners, 1e-9));
  EXPECT_FALSE(bordersIn({SphereRegion{{0, 0, 1}, 0.1}}, corners, 1e-9)) << "as good as the corner alone";
  EXPECT_FALSE(bordersIn({below(0.5), below(2.0)}, corners, 1e-9)) << "all of it is held";
  EXPECT_FALSE(bordersIn({}, corners, 1e-9));
  EXPECT_TRUE(bordersIn({BoxRegion{{-1, -1, 0.2}, {1, 1, 0.3}}}, corners, 1e-9)) << "no corner shows it";
  EXPECT_FALSE(bordersIn({BoxRegion{{-1, -1, -0.2}, {1, 1, 0.05}}}, corners, 1e-9)) << "as good as a face";
  EXPECT_FALSE(bordersIn({SphereRegion{{3, 0, 0}, 1.5}, BoxRegion{{2, 0, 0}, {3, 1, 1}}, below(-1.0)}, corners, 1e-9));
}

TEST(FixedNodes, NamesTheRegionThatHoldsNoNodeAndTheMesh) {
  const Region good = SphereRegion{{0, 0, 0}, 0.1};
  expectRefusal(
      [&] {
        fixedOf({good, BoxRegion{{2, 3, 4}, {5, 6, 7}}});
      },
      {"tissue 'liver': fixed region 1 (box", "2 3 4", "5 6 7", "0 0 0", "1 1 1"});
  expectRefusal([&] { fixedOf({PlaneRegion{{0, 0, -9}, {0, 0, 1}}}); }, {"fixed region 0 (plane", "0  0 -9"});
  expectRefusal([&] { fixedOf({SphereRegion{{0, 0, 8}, 0.5}}); }, {"fixed region 0 (sphere", "0 0 8", "0.5"});
}

TEST(FixedNodes, RefusesRegionsThatAreNotNumbersOrHaveNoDirection) {
  expectRefusal([&] { fixedOf({BoxRegion{{kNan, 0, 0}, {1, 1, 1}}}); }, {"fixed region 0", "nan"});
  expectRefusal([&] { fixedOf({PlaneRegion{{kNan, 0, 0}, {0, 0, 1}}}); }, {"fixed region 0", "nan"});
  expectRefusal([&] { fixedOf({PlaneRegion{{0, 0, 0}, {0, 0, 0}}}); }, {"fixed region 0"});
  expectRefusal([&] { fixedOf({PlaneRegion{{0, 0, 0}, {kNan, 0, 0}}}); }, {"fixed region 0"});
  expectRefusal([&] { fixedOf({SphereRegion{{0, 0, 0}, kNan}}); }, {"fixed region 0", "nan"});
  expectRefusal([&] { fixedOf({SphereRegion{{0, 0, 0}, -1.0}}); }, {"fixed region 0"});
  expectRefusal([&] { fixedNodes(NodalVectors(3, 0), {SphereRegion{{0, 0, 0}, 1}}, "m"); }, {"no nodes"});
}

}  // namespace tet_mesh_test
}  // namespace tissue_contact
