/// Physical groups of Gmsh files and cell data of VTK files: what they hold, and what is refused.
#include "mesh/labels.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <string>
#include <utility>
#include <variant>
#include <vector>

#include "mesh/region.h"
#include "mesh_writers.h"

namespace tissue_contact {
namespace labels_test {

/// Two tetrahedra, the second one's outer face, and one node, in groups; by version of the format.
const char* const kGroups22 =
    "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n"
    "$PhysicalNames\n3\n3 7 \"tumour\"\n2 9 \"free end\"\n3 6 \"rest\"\n$EndPhysicalNames\n"
    "$Nodes\n5\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n5 1 1 1\n$EndNodes\n"
    "$Elements\n4\n1 15 2 4 1 1\n2 2 2 9 1 3 4 5\n3 4 2 6 1 1 2 3 4\n4 4 2 7 1 2 3 4 5\n$EndElements\n";

const char* const kGroups41 =
    "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n"
    "$PhysicalNames\n3\n3 7 \"tumour\"\n2 9 \"free end\"\n3 6 \"rest\"\n$EndPhysicalNames\n"
    "$Entities\n1 0 1 2\n1 0 0 0 1 4\n1 0 0 0 1 1 1 1 -9 0\n1 0 0 0 1 1 1 1 6 0\n2 0 0 0 1 1 1 1 7 1 -1\n$EndEntities\n"
    "$Nodes\n1 5 1 5\n3 1 0 5\n1\n2\n3\n4\n5\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 1 1\n$EndNodes\n"
    "$Elements\n4 4 1 4\n0 1 15 1\n1 1\n2 1 2 1\n2 3 4 5\n3 1 4 1\n3 1 2 3 4\n3 2 4 1\n4 2 3 4 5\n$EndElements\n";

const char* const kCellData =
    "# vtk DataFile Version 3.0\ntwo\nASCII\nDATASET UNSTRUCTURED_GRID\n"
    "POINTS 5 double\n0 0 0 1 0 0 0 1 0 0 0 1 1 1 1\n"
    "CELLS 3 14\n3 2 3 4\n4 0 1 2 3\n4 1 2 3 4\nCELL_TYPES 3\n5 10 10\n"
    "POINT_DATA 5\nVECTORS u float\n0 0 0 0 0 0 0 0 0 0 0 0 0 0 0\nSCALARS t double 1\nLOOKUP_TABLE default\n1 2 3 4 "
    "5\n"
    "CELL_DATA 3\nSCALARS region int\nLOOKUP_TABLE default\n1 1 2\n"
    "FIELD more 2\nstiffness 1 3 double\n0 5 2.5\nfibre 3 3 float\n0 0 1 0 0 1 0 0 1\n";

struct Loaded {
  TetMesh mesh;
  MeshLabels labels;
};

Loaded load(const std::string& bytes) {
  Loaded loaded;
  loaded.mesh = loadTetMesh(meshFile(FileOfBytes(bytes).path()), {}, &loaded.labels);
  return loaded;
}

std::vector<bool> heldNodes(const Loaded& loaded, const Region& region) {
  return fixedNodes(loaded.mesh.positions, withPlaces({region}, loaded.labels, loaded.mesh, "fixed", "tissue"),
                    "tissue");
}

std::vector<bool> heldElements(const Loaded& loaded, const Region& region) {
  NodalVectors centroids(3, 2);
  for (int e = 0; e < 2; ++e) {
    Vector3 sum = Vector3::Zero();
    for (const int node : loaded.mesh.tetrahedra[static_cast<std::size_t>(e)]) sum += loaded.mesh.positions.col(node);
    centroids.col(e) = sum / 4.0;
  }
  const auto regions = withPlaces({region}, loaded.labels, loaded.mesh, "where", "tissue");
  return heldPoints(centroids, regions, "where", "centroid", "tissue");
}

/// MSH 1 has numbers only.
const char* const kGroups1 =
    "$NOD\n5\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n5 1 1 1\n$ENDNOD\n"
    "$ELM\n4\n1 15 4 1 1 1\n2 2 9 1 3 3 4 5\n3 4 6 1 4 1 2 3 4\n4 4 7 1 4 2 3 4 5\n$ENDELM\n";

TEST(MeshLabels, PhysicalGroupsOfTheFirstFormat) {
  const Loaded loaded = load(kGroups1);
  expectSameMesh(loaded.mesh, twoTetrahedra());
  EXPECT_EQ(heldElements(loaded, GroupRegion{"7"}), (std::vector<bool>{false, true}));
  EXPECT_EQ(heldNodes(loaded, GroupRegion{"9"}), (std::vector<bool>{false, false, true, true, true}));
  EXPECT_EQ(heldNodes(loaded, GroupRegion{"4"}), (std::vector<bool>{true, false, false, false, false}));
}

TEST(MeshLabels, PhysicalGroupsOfEveryVersion) {
  for (const char* text : {kGroups22, kGroups41}) {
    SCOPED_TRACE(text);
    const Loaded loaded = load(text);
    expectSameMesh(loaded.mesh, twoTetrahedra());
    EXPECT_EQ(heldElements(loaded, GroupRegion{"tumour"}), (std::vector<bool>{false, true}));
    EXPECT_EQ(heldElements(loaded, GroupRegion{"7"}), (std::vector<bool>{false, true})) << "by its number";
    EXPECT_EQ(heldNodes(loaded, GroupRegion{"tumour"}), (std::vector<bool>{false, true, true, true, true}));
    EXPECT_EQ(heldNodes(loaded, GroupRegion{"free end"}), (std::vector<bool>{false, false, true, true, true}));
    EXPECT_EQ(heldNodes(loaded, GroupRegion{"4"}), (std::vector<bool>{true, false, false, false, false}));
    expectRefusal([&] { heldElements(loaded, GroupRegion{"free end"}); }, {"free end", "no centroid"});
  }
}

/// Of quadratic elements the corners: nodes 6 to 14 are the middles of edges, the group's triangle has three of them.
TEST(MeshLabels, PhysicalGroupsOfElementsOfHigherOrder) {
  std::string text(kGroups22);
  text = replaced(text, "$Nodes\n5\n",
                  "$Nodes\n14\n6 .5 0 0\n7 0 .5 0\n8 0 0 .5\n9 .5 .5 0\n10 0 .5 .5\n11 .5 0 .5\n12 1 .5 .5\n13 .5 1 "
                  ".5\n14 .5 .5 1\n");
  text = replaced(text, "2 2 2 9 1 3 4 5", "2 9 2 9 1 3 4 5 10 14 13");
  text = replaced(text, "3 4 2 6 1 1 2 3 4", "3 11 2 6 1 1 2 3 4 6 9 7 8 10 11");
  text = replaced(text, "4 4 2 7 1 2 3 4 5", "4 11 2 7 1 2 3 4 5 9 10 11 12 14 13");
  const Loaded loaded = load(text);
  expectSameMesh(loaded.mesh, twoTetrahedra());
  EXPECT_EQ(heldElements(loaded, GroupRegion{"tumour"}), (std::vector<bool>{false, true}));
  EXPECT_EQ(heldNodes(loaded, GroupRegion{"free end"}), (std::vector<bool>{false, false, true, true, true}));
}

TEST(MeshLabels, UnknownGroupsAreToldWhatThereIs) {
  const Loaded loaded = load(kGroups22);
  expectRefusal([&] { heldNodes(loaded, GroupRegion{"tumor"}); },
                {"no group \"tumor\"", "tumour", "free end", "rest", "4"});
  expectRefusal([&] { heldNodes(load(kCellData), GroupRegion{"tumour"}); }, {"no physical groups", ".msh"});
}

TEST(MeshLabels, CellDataOfScalarsAndFields) {
  const Loaded loaded = load(kCellData);
  EXPECT_EQ(heldElements(loaded, CellDataRegion{"region", 2.0}), (std::vector<bool>{false, true}));
  EXPECT_EQ(heldElements(loaded, CellDataRegion{"stiffness", 5.0}), (std::vector<bool>{true, false}));
  Loaded single = loaded;
  single.labels.cell_data.at(0).values = {0.1F, 0.2F};
  EXPECT_EQ(heldElements(single, CellDataRegion{"region", 0.2}), (std::vector<bool>{false, true}));
  single.labels.cell_data.at(0).values = {16777216.0, 16777217.0};  // alike in single precision
  EXPECT_EQ(heldElements(single, CellDataRegion{"region", 16777217.0}), (std::vector<bool>{false, true}));
  EXPECT_EQ(heldNodes(loaded, CellDataRegion{"region", 1.0}), (std::vector<bool>{true, true, true, true, false}))
      << "a triangle's value is not a tetrahedron's";
  expectRefusal([&] { heldNodes(loaded, CellDataRegion{"region", 3.0}); }, {"region", "= 3", "values are: 1, 2"});
  expectRefusal(
      [&] {
        heldNodes(loaded, CellDataRegion{"fibre", 1.0});
      },
      {"no cell data \"fibre\"", "there are: region, stiffness"});
}

// Six times as many were kept: 2.29 GB for a file of 49 MB, of hexahedra with thousands of arrays.
TEST(MeshLabels, CellDataAreKeptOncePerVolumeHoweverManyTetrahedraItBecomes) {
  const Loaded loaded = load(
      "# vtk DataFile Version 3.0\ntwo\nASCII\nDATASET UNSTRUCTURED_GRID\n"
      "POINTS 12 double\n0 0 0 1 0 0 0 1 0 1 1 0 0 0 1 1 0 1 0 1 1 1 1 1 0 0 2 1 0 2 0 1 2 1 1 2\n"
      "CELLS 2 18\n8 0 1 3 2 4 5 7 6\n8 4 5 7 6 8 9 11 10\nCELL_TYPES 2\n12 12\n"
      "CELL_DATA 2\nSCALARS part int\nLOOKUP_TABLE default\n4 5\n");
  ASSERT_GE(loaded.mesh.tetrahedra.size(), 10u);
  EXPECT_EQ(loaded.labels.cell_data.at(0).values, (std::vector<double>{4.0, 5.0}));
  const std::vector<bool> lower = {true, true, true, true, true, true, true, true, false, false, false, false};
  EXPECT_EQ(heldNodes(loaded, CellDataRegion{"part", 4.0}), lower);
}

TEST(MeshLabels, AreNotLookedAtUnlessAskedFor) {
  const std::string damaged = replaced(kGroups22, "3 7 \"tumour\"", "3 7 tumour");
  EXPECT_NO_THROW(loadBytes(damaged));
  expectRefusal([&] { load(damaged); }, {":6:", "in quotes"});
  EXPECT_NO_THROW(loadBytes(std::string(kCellData) + "rubbish"));
}

// Or each of a million elements would be compared with the ten thousand places of its plane.
TEST(MeshLabels, PlacesOfAStructuredMeshHardlyEverComeSideBySide) {
  constexpr int kCells = 64;
  std::vector<double> orders;
  for (int i = 0; i < kCells; ++i) {
    for (int j = 0; j < kCells; ++j) {
      for (int k = 0; k < kCells; ++k) orders.push_back(placeOrder(Vector3(i, j, k) * 1e-3));
    }
  }
  std::sort(orders.begin(), orders.end());
  constexpr double kTwiceRounding = 2e-9 * 0.11;
  for (std::size_t first = 0, last = 0; last < orders.size(); ++last) {
    while (orders[last] - orders[first] > kTwiceRounding) ++first;
    ASSERT_LT(last - first, 4U) << orders[last];
  }
}

/// Gmsh numbers groups of each dimension by themselves.
TEST(MeshLabels, AGroupOfTwoDimensionsIsNoneOfThem) {
  const Loaded loaded = load(replaced(kGroups1, "2 2 9 1 3", "2 2 7 1 3"));
  expectRefusal([&] { heldNodes(loaded, GroupRegion{"7"}); },
                {"group \"7\" is one of surfaces and one of volumes", "number of its own"});
}

/// Of partitioned meshes Gmsh writes the names alone.
TEST(MeshLabels, AGroupWithoutElementsSaysSo) {
  const Loaded loaded = load(replaced(kGroups22, "2 2 2 9 1 3 4 5", "2 2 2 0 1 3 4 5"));
  expectRefusal([&] { heldNodes(loaded, GroupRegion{"free end"}); },
                {"\"free end\" has no elements in the file", "partitioned"});
}

TEST(MeshLabels, NumbersOfGroupsHave32Bits) {
  expectRefusal([&] { load(replaced(kGroups41, "1 1 1 1 6 0", "1 1 1 1 -9223372036854775808 0")); },
                {"more than 32 bits"});
}

/// Bytes above 127 and their kin, which the cursor reads as negative.
TEST(MeshLabels, UnsignedCellDataAreNotNegative) {
  for (const auto& [type, bytes] :
       {std::pair<const char*, unsigned>{"unsigned_char", 1}, {"unsigned_short", 2}, {"unsigned_int", 4}}) {
    ByteWriter data(true);
    const double largest = std::ldexp(1.0, static_cast<int>(8 * bytes)) - 1.0;
    data.text(VtkWriter({"3.0", true, 8, 8, false}).write(twoTetrahedra()));
    data.text("\nCELL_DATA 3\nSCALARS part " + std::string(type) + " 1\nLOOKUP_TABLE default\n");
    data.integer(0, bytes).integer(-1, bytes).integer(7, bytes);
    const Loaded loaded = load(data.bytes());
    EXPECT_EQ(loaded.labels.cell_data.at(0).values, (std::vector<double>{largest, 7.0})) << type;
  }
}

/// What else VTK writes beside the arrays that are looked for; names with what is no letter.
TEST(MeshLabels, OtherCellDataAreSkipped) {
  const std::string others =
      "CELL_DATA 3\nCOLOR_SCALARS shade 3\n0 0 0 .5 .5 .5 1 1 1\nGLOBAL_IDS ids vtkIdType\n3 4 5\n"
      "TEXTURE_COORDINATES uv 2 float\n0 0 0 1 1 1\nLOOKUP_TABLE colours 2\n0 0 0 1 1 1 1 1\n"
      "SCALARS Region%20Id int\nLOOKUP_TABLE default\n4 5 6\n";
  const Loaded loaded = load(replaced(kCellData, "CELL_DATA 3\n", others));
  EXPECT_EQ(heldElements(loaded, CellDataRegion{"Region Id", 6.0}), (std::vector<bool>{false, true}));
  EXPECT_EQ(heldElements(loaded, CellDataRegion{"ids", 4.0}), (std::vector<bool>{true, false}));
  EXPECT_EQ(heldElements(loaded, CellDataRegion{"stiffness", 5.0}), (std::vector<bool>{true, false}));
}

TEST(MeshLabels, DamagedOnesAreRefused) {
  expectRefusal([&] { load(std::string(kCellData) + "rubbish\n"); }, {"RUBBISH", "not read"});
  expectRefusal([&] { load(replaced(kCellData, "CELL_DATA 3", "CELL_DATA 4")); },
                {"CELL_DATA is for 4", "there are 3"});
  expectRefusal([&] { load(replaced(kCellData, "1 1 2\n", "1 1\n")); }, {"FIELD"});
  std::string many = "17";
  for (int i = 1; i <= 17; ++i) many += " " + std::to_string(i);
  expectRefusal([&] { load(replaced(kGroups41, "1 1 1 1 6 0\n", "1 1 1 " + many + " 0\n")); },
                {"17 physical groups", "16"});
}

}  // namespace labels_test
}  // namespace tissue_contact
