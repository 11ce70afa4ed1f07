/// Generated sheets, shells from files, and what is refused of them.
#include <gtest/gtest.h>

#include <limits>
#include <map>
#include <stdexcept>

#include "support/refusal.h"
#include "support/temporary_directory.h"
#include "tissue_contact/mesh/triangle_mesh.h"

namespace tissue_contact {
namespace sheet_mesh_test {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

void expectRefused(const TriangleMesh& mesh, const std::vector<std::string>& words) {
  const std::string message = refusal([&] { checkSheetMesh(mesh, "tissue 'flap'"); });
  EXPECT_EQ(message.rfind("tissue 'flap': ", 0), 0U) << message;
  expectContains(message, words);
}

/// A square of two triangles.
TriangleMesh square() {
  TriangleMesh mesh;
  mesh.vertices.resize(3, 4);
  mesh.vertices.transpose() << 0, 0, 0, 1, 0, 0, 1, 1, 0, 0, 1, 0;
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  return mesh;
}

TEST(SheetMesh, IsACentredGridThatFacesUp) {
  const TriangleMesh mesh = makeSheetMesh({Vector2(0.3, 0.7), {3, 2}, 1e-3});
  ASSERT_EQ(mesh.vertices.cols(), 4 * 3);
  ASSERT_EQ(mesh.triangles.size(), 2U * 3 * 2);
  EXPECT_EQ(mesh.vertices.row(0).minCoeff(), -0.15);
  EXPECT_EQ(mesh.vertices.row(0).maxCoeff(), 0.15);
  EXPECT_EQ(mesh.vertices.row(1).minCoeff(), -0.35);
  EXPECT_EQ(mesh.vertices.row(1).maxCoeff(), 0.35);
  EXPECT_TRUE(mesh.vertices.col(1).isApprox(Vector3(-0.05, -0.35, 0.0)));  // x fastest
  double area = 0.0;
  for (const Triangle& t : mesh.triangles) {
    const Vector3 a = mesh.vertices.col(t[1]) - mesh.vertices.col(t[0]);
    const Vector3 b = mesh.vertices.col(t[2]) - mesh.vertices.col(t[0]);
    EXPECT_GT(a.cross(b).z(), 0.0);
    area += triangleArea(mesh.vertices, t);
  }
  EXPECT_NEAR(area, 0.21, 1e-15);
  EXPECT_NO_THROW(checkSheetMesh(mesh, "sheet"));
}

// Diagonals meet in every other node: 4 and 8 triangles in turn around the inner ones.
TEST(SheetMesh, DiagonalsAlternate) {
  const TriangleMesh mesh = makeSheetMesh({Vector2(0.4, 0.4), {4, 4}, 1e-3});
  std::map<int, int> triangles;
  for (const Triangle& t : mesh.triangles) {
    for (const int node : t) ++triangles[node];
  }
  for (int j = 1; j < 4; ++j) {
    for (int i = 1; i < 4; ++i) EXPECT_EQ(triangles[i + 5 * j], (i + j) % 2 == 0 ? 8 : 4);
  }
}

TEST(SheetMesh, RefusesSizesAndCellsOutOfRange) {
  EXPECT_THROW(makeSheetMesh({Vector2(0.0, 1.0), {1, 1}, 1e-3}), std::invalid_argument);
  EXPECT_THROW(makeSheetMesh({Vector2(1.0, kNan), {1, 1}, 1e-3}), std::invalid_argument);
  EXPECT_THROW(makeSheetMesh({Vector2(1.0, 1.0), {0, 1}, 1e-3}), std::invalid_argument);
  EXPECT_THROW(makeSheetMesh({Vector2(1.0, 1.0), {1, -1}, 1e-3}), std::invalid_argument);
  EXPECT_THROW(makeSheetMesh({Vector2(1.0, 1.0), {2000, 2000}, 1e-3}), std::invalid_argument);
  EXPECT_THROW(makeSheetMesh({Vector2(1.0, 1.0), {2147483647, 2147483647}, 1e-3}), std::invalid_argument);
}

TEST(CheckSheetMesh, AcceptsAGoodMeshInAnyUnit) {
  for (const double scale : {1e-30, 1e-9, 1.0, 1e3, 1e100}) {
    TriangleMesh mesh = square();
    mesh.vertices *= scale;
    EXPECT_NO_THROW(checkSheetMesh(mesh, "mesh")) << scale;
  }
}

TEST(CheckSheetMesh, NamesWhatIsWrong) {
  expectRefused(TriangleMesh{}, {"no triangles"});
  TriangleMesh mesh = square();
  mesh.vertices(1, 2) = kNan;
  expectRefused(mesh, {"node 2", "finite"});
  mesh = square();
  mesh.triangles[1][2] = 4;
  expectRefused(mesh, {"triangle 1 refers to node 4", "4 nodes"});
  mesh.triangles[1][2] = -1;
  expectRefused(mesh, {"triangle 1 refers to node -1"});
  mesh = square();
  mesh.vertices.col(3) << 0.5, 0.5, 0.0;
  expectRefused(mesh, {"triangle 1 (nodes 0, 2, 3) has no area"});
  mesh.vertices.col(3) = mesh.vertices.col(0);
  expectRefused(mesh, {"triangle 1", "no area"});
  mesh = square();
  mesh.triangles.push_back({2, 0, 1});
  expectRefused(mesh, {"triangle 2 has the same three nodes as triangle 0"});
  mesh = square();
  mesh.triangles[1] = {0, 3, 2};
  expectRefused(mesh, {"the edge of nodes 0 and 2", "triangles 0 and 1", "wound against each other"});
  mesh = square();
  mesh.vertices.conservativeResize(3, 5);
  mesh.vertices.col(4) << 1.0, 0.0, 1.0;
  expectRefused(mesh, {"node 4 belongs to no triangle"});
  mesh.triangles.push_back({2, 0, 4});
  expectRefused(mesh, {"the edge of nodes 0 and 2 belongs to 3 triangles", "0 and 1 and 2"});
}

class ShellFile : public ::testing::Test {
 protected:
  void write(const std::string& text) const { directory_.write("shell.obj", text); }

  TemporaryDirectory directory_;
  std::string path = directory_.path("shell.obj");
};

TEST_F(ShellFile, IsReadWithItsScale) {
  write("v 0 0 0\nv 10 0 0\nv 10 10 0\nv 0 10 2\nf 1 2 3\nf 1 3 4\n");
  const TriangleMesh mesh = loadShellMesh({path, 0.001, 1e-3});
  EXPECT_NO_THROW(checkSheetMesh(mesh, "shell"));
  ASSERT_EQ(mesh.vertices.cols(), 4);
  ASSERT_EQ(mesh.triangles.size(), 2U);
  EXPECT_NEAR(mesh.vertices.row(0).maxCoeff(), 0.01, 1e-9);
  EXPECT_NEAR(mesh.vertices.row(2).maxCoeff(), 0.002, 1e-9);
}

TEST_F(ShellFile, BadScaleAndMissingFileAreNamed) {
  write("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n");
  for (const double scale : {0.0, -1.0, kNan}) {
    expectRefusal([&] { loadShellMesh({path, scale, 1e-3}); }, {"scale_m_per_unit"});
  }
  EXPECT_THROW(loadShellMesh({path + ".gone", 1.0, 1e-3}), std::invalid_argument);
}

}  // namespace sheet_mesh_test
}  // namespace tissue_contact
