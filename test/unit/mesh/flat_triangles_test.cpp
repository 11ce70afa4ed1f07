#include "mesh/reader/flat_triangles.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <algorithm>
#include <stdexcept>
#include <string>
#include <vector>

#include "mesh/fill/fill_surface.h"
#include "mesh/nodes.h"
#include "mesh/shell_notes.h"
#include "mesh_fixture.h"
#include "tissue_contact/mesh/gmsh_version.h"
#include "tissue_contact/mesh/tet_mesh.h"
#include "unit/instrument/instrument_fixture.h"

namespace tissue_contact {
namespace flat_triangles_test {

/// A cube of edge 30; the middle of one edge is a corner of one side alone, and a flat triangle closes the gap to the other.
TetrahedronShape cube() {
  TetrahedronShape shape;
  shape.vertices.clear();
  for (const int i : {0, 1, 2, 3, 4, 5, 6, 7}) shape.vertices.emplace_back(30 * (i & 1), 15 * (i & 2), 7.5 * (i & 4));
  shape.vertices.emplace_back(15, 0, 0);
  shape.triangles = {{0, 2, 3}, {0, 3, 1}, {4, 5, 7}, {4, 7, 6}, {2, 6, 7}, {2, 7, 3}, {0, 4, 6},
                     {0, 6, 2}, {1, 3, 7}, {1, 7, 5}, {0, 8, 4}, {8, 1, 5}, {8, 5, 4}, {0, 1, 8}};
  return shape;
}

double areaOf(const TriangleMesh& mesh) {
  double area = 0.0;
  for (const Triangle& t : mesh.triangles) area += triangleArea(mesh.vertices, t);
  return area;
}

// Without, three edges are open, and of the turned ones the flat triangle stays, with a normal that is rounding.
TEST(AbsorbFlatTriangles, OfAClosedSurfaceAlsoTurnedAndFarAway) {
  TemporaryDirectory directory;
  for (const double far : {0.0, 1000.0}) {
    for (const double angle : {0.0, 0.4, 1.1}) {
      TetrahedronShape shape = cube();
      const Eigen::AngleAxisd R(angle, Vector3(1, 2, 3).normalized());
      for (Vector3& p : shape.vertices) p = R * p + far * Vector3(0.3, 1.0, -0.7);
      const TriangleMesh mesh = loadTriangleMesh(directory.write("cube.stl", binaryStl(shape)), Vector3::Ones());
      EXPECT_EQ(mesh.vertices.cols(), 9);
      EXPECT_EQ(mesh.triangles.size(), 14u);
      EXPECT_TRUE(isClosedAndOriented(mesh)) << far << " " << angle;
      EXPECT_NEAR(enclosedVolume(mesh), 27000.0, 1.0);
      EXPECT_NEAR(areaOf(mesh), 5400.0, 0.2);
      for (const Triangle& t : mesh.triangles) EXPECT_GT(triangleArea(mesh.vertices, t), 100.0) << far << " " << angle;
    }
  }
}

// Refused before: "it passes through itself ... Singular matrix".
TEST(FillFlatTriangles, WithAFlatTriangleThatClosesAGap) {
  try {
    gmshVersion();
  } catch (const std::invalid_argument& error) {
    GTEST_SKIP() << error.what();
  }
  TemporaryDirectory directory;
  MeshDescription description;
  description.file = directory.write("cube.stl", binaryStl(cube()));
  description.scale_m_per_unit = 0.001;
  description.cell_size_m = 0.01;
  const TetMesh mesh = fillSurface(description, {});
  double volume = 0.0;
  for (const Tetrahedron& tet : mesh.tetrahedra) volume += signedVolume(mesh.positions, tet);
  EXPECT_NEAR(volume, 2.7e-5, 1e-9);
}

/// A strip: one triangle whose side is the whole seam, at x = 0, and four whose sides are parts of it, each a node of it.
TriangleMesh seam() {
  TriangleMesh mesh;
  mesh.vertices = columnsOf({{0, 0, 0}, {0, 1, 0}, {0, 2, 0}, {0, 3, 0}, {0, 4, 0}, {-3, 2, 0}, {2, 2, 0}});
  mesh.triangles = {{0, 4, 5}, {0, 6, 1}, {1, 6, 2}, {2, 6, 3}, {3, 6, 4}};
  return mesh;
}

TEST(AbsorbFlatTriangles, FlatOnesBesideFlatOnesTakeTheirTurn) {
  TriangleMesh mesh = seam();
  const double area = areaOf(mesh);
  mesh.triangles.insert(mesh.triangles.end(), {{0, 1, 2}, {0, 2, 3}, {0, 3, 4}});  // the last one first
  absorbFlatTriangles(mesh);
  ASSERT_EQ(mesh.triangles.size(), 8u);
  EXPECT_NEAR(areaOf(mesh), area, 1e-12);
  EXPECT_NO_THROW(checkSheetMesh(mesh, "strip"));  // which refuses flat ones and edges of three
  EXPECT_TRUE(shellNotes(mesh).empty());
  int at_seam = 0;
  for (const Triangle& t : mesh.triangles) at_seam += std::count(t.begin(), t.end(), 5) > 0 ? 1 : 0;
  EXPECT_EQ(at_seam, 4);
}

TEST(AbsorbFlatTriangles, WhatHasNoNeighbourAcrossStays) {
  const auto stays = [](TriangleMesh mesh) {
    const std::vector<Triangle> given = mesh.triangles;
    absorbFlatTriangles(mesh);
    return mesh.triangles == given;
  };
  TriangleMesh mesh = seam();
  EXPECT_TRUE(stays(mesh));
  mesh.triangles.erase(mesh.triangles.begin());
  mesh.triangles.push_back({0, 1, 2});  // at the border
  EXPECT_TRUE(stays(mesh));
  mesh.triangles = {{0, 2, 1}, {2, 0, 3}};  // two on each other
  mesh.vertices.col(3) = Vector3(0, 1.5, 0);
  EXPECT_TRUE(stays(mesh));
  mesh.triangles = {{0, 2, 1}, {0, 2, 5}, {0, 2, 6}};  // an edge of three
  EXPECT_TRUE(stays(mesh));
  EXPECT_TRUE(stays({}));
}

// One unit of the last place apart, 6e-5; within 2e-6 nodes were one before, so that this was two parts.
TEST(MergeVertices, WhatSinglePrecisionDoesNotTellApartIsOne) {
  TemporaryDirectory directory;
  TetrahedronShape shape;
  shape.vertices = {{900, 0, 0}, {900, 10, 0}, {890, 0, 0}, {900.00006, 0, 0}, {900.00006, 10, 0}, {910, 0, 0}};
  shape.triangles = {{0, 1, 2}, {4, 3, 5}};
  const TriangleMesh mesh = loadTriangleMesh(directory.write("shell.stl", binaryStl(shape)), Vector3::Ones());
  EXPECT_EQ(mesh.vertices.cols(), 4);
  EXPECT_TRUE(shellNotes(mesh).empty());
}

TEST(ShellNotes, TellPartsAndNodesThatAllButMeet) {
  TriangleMesh mesh;
  mesh.vertices = columnsOf({{0, 0, 0}, {0, 1, 0}, {-1, 0, 0}, {1e-3, 0, 0}, {1e-3, 1, 0}, {1, 0, 0}});
  mesh.triangles = {{0, 1, 2}, {4, 3, 5}};
  const std::vector<std::string> notes = shellNotes(mesh);
  ASSERT_EQ(notes.size(), 2u);
  expectContains(notes[0], {"2 nodes of its border", "0.001 m away at (0, 0, 0) m", "cut open", "Merge by Distance"});
  expectContains(notes[1], {"2 parts that share no node"});
  for (const int i : {3, 4}) mesh.vertices(0, i) = 0.1;
  EXPECT_EQ(shellNotes(mesh).size(), 1u);
}

}  // namespace flat_triangles_test
}  // namespace tissue_contact
