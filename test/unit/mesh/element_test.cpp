/// @file
/// Hexahedra, prisms and pyramids of mesh files, split into tetrahedra that hang together.
#include "mesh/reader/element.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <numeric>
#include <random>
#include <sstream>
#include <string>
#include <vector>

#include "mesh/conformity.h"
#include "mesh/labels.h"
#include "mesh/nodes.h"
#include "mesh/region.h"
#include "mesh_writers.h"

namespace tissue_contact {
namespace element_test {

struct Volumes {
  NodalVectors nodes;
  std::vector<std::vector<int>> elements;
};

/// A grid of hexahedra of unit edges, its nodes in the order of `number`.
Volumes grid(const std::array<int, 3>& cells, const std::vector<int>& number) {
  const auto node = [&](int i, int j, int k) {
    const int place = i + (cells[0] + 1) * (j + (cells[1] + 1) * k);
    return number[static_cast<std::size_t>(place)];
  };
  Volumes made;
  made.nodes.resize(3, static_cast<Eigen::Index>(number.size()));
  for (int k = 0; k <= cells[2]; ++k) {
    for (int j = 0; j <= cells[1]; ++j) {
      for (int i = 0; i <= cells[0]; ++i) made.nodes.col(node(i, j, k)) = Vector3(i, j, k);
    }
  }
  for (int k = 0; k < cells[2]; ++k) {
    for (int j = 0; j < cells[1]; ++j) {
      for (int i = 0; i < cells[0]; ++i) {
        made.elements.push_back({node(i, j, k), node(i + 1, j, k), node(i + 1, j + 1, k), node(i, j + 1, k),
                                 node(i, j, k + 1), node(i + 1, j, k + 1), node(i + 1, j + 1, k + 1),
                                 node(i, j + 1, k + 1)});
      }
    }
  }
  return made;
}

std::vector<int> ascending(std::size_t count) {
  std::vector<int> number(count);
  std::iota(number.begin(), number.end(), 0);
  return number;
}

TetMesh split(const Volumes& volumes) {
  TetMesh mesh{volumes.nodes, {}};
  for (const std::vector<int>& element : volumes.elements) {
    ElementCorners corners = kNoCorners;
    std::copy(element.begin(), element.end(), corners.begin());
    addTetrahedra(corners, mesh.tetrahedra);
  }
  return mesh;
}

void expectSound(const TetMesh& mesh, double volume) {
  EXPECT_NO_THROW(checkTetMesh(mesh, "mesh"));
  EXPECT_NO_THROW(checkConforming(mesh, "mesh"));
  EXPECT_NEAR(totalVolume(mesh), volume, 1e-12 * volume);
}

/// However nodes are numbered, elements side by side agree about the diagonals between them.
TEST(Element, HexahedraHangTogetherHoweverTheyAreNumbered) {
  std::mt19937 random(1);
  std::vector<int> number = ascending(4 * 3 * 4);
  for (int trial = 0; trial < 20; ++trial) {
    const TetMesh mesh = split(grid({3, 2, 3}, number));
    EXPECT_EQ(mesh.tetrahedra.size(), 18U * 6U);
    expectSound(mesh, 18.0);
    EXPECT_EQ(boundaryTriangles(mesh.tetrahedra).size(), 2U * 42U);
    std::shuffle(number.begin(), number.end(), random);
  }
}

/// A cube of six pyramids below, one of two prisms above.
TEST(Element, ShapesHangTogether) {
  std::mt19937 random(2);
  for (int trial = 0; trial < 50; ++trial) {
    std::vector<int> number = ascending(13);
    if (trial > 0) std::shuffle(number.begin(), number.end(), random);
    Volumes volumes;
    volumes.nodes.resize(3, 13);
    const auto at = [&](int i, int j, int k) {
      const int place = i + 2 * j + 4 * k;
      return number[static_cast<std::size_t>(place)];
    };
    for (int k = 0; k < 3; ++k) {
      for (int j = 0; j < 2; ++j) {
        for (int i = 0; i < 2; ++i) volumes.nodes.col(at(i, j, k)) = Vector3(i, j, k);
      }
    }
    volumes.nodes.col(number[12]) = Vector3(0.5, 0.5, 0.5);
    const int apex = number[12];
    volumes.elements = {{at(0, 0, 0), at(1, 0, 0), at(1, 1, 0), at(0, 1, 0), apex},
                        {at(0, 1, 1), at(1, 1, 1), at(1, 0, 1), at(0, 0, 1), apex},
                        {at(0, 0, 0), at(0, 0, 1), at(1, 0, 1), at(1, 0, 0), apex},
                        {at(0, 1, 0), at(1, 1, 0), at(1, 1, 1), at(0, 1, 1), apex},
                        {at(0, 0, 0), at(0, 1, 0), at(0, 1, 1), at(0, 0, 1), apex},
                        {at(1, 0, 0), at(1, 0, 1), at(1, 1, 1), at(1, 1, 0), apex},
                        {at(0, 0, 1), at(0, 0, 2), at(1, 0, 1), at(0, 1, 1), at(0, 1, 2), at(1, 1, 1)},
                        {at(1, 0, 1), at(0, 0, 2), at(1, 0, 2), at(1, 1, 1), at(0, 1, 2), at(1, 1, 2)}};
    const TetMesh mesh = split(volumes);
    EXPECT_EQ(mesh.tetrahedra.size(), 6U * 2U + 2U * 3U);
    expectSound(mesh, 2.0);
  }
}

/// A hexahedron that has collapsed to a prism, as mesh generators write them, and one to a point: nothing flat is left.
TEST(Element, CollapsedCornersAreLeftOut) {
  Volumes one = grid({1, 1, 1}, ascending(8));
  one.elements[0][2] = one.elements[0][1];
  one.elements[0][6] = one.elements[0][5];
  TetMesh mesh = split(one);
  dropUnusedNodes(mesh.positions, mesh.tetrahedra);
  EXPECT_EQ(mesh.tetrahedra.size(), 3U);
  expectSound(mesh, 0.5);
  one.elements[0] = std::vector<int>(8, 3);
  EXPECT_TRUE(split(one).tetrahedra.empty());
}

std::string vtkText(const Volumes& volumes, const std::vector<int>& types, const std::string& more = "") {
  std::ostringstream text;
  text << "# vtk DataFile Version 3.0\nvolumes\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS " << volumes.nodes.cols()
       << " double\n";
  text << volumes.nodes.transpose() << "\n";
  std::size_t size = 0;
  for (const auto& element : volumes.elements) size += 1 + element.size();
  text << "CELLS " << volumes.elements.size() << " " << size << "\n";
  for (const auto& element : volumes.elements) {
    text << element.size();
    for (const int node : element) text << " " << node;
    text << "\n";
  }
  text << "CELL_TYPES " << types.size() << "\n";
  for (const int type : types) text << type << "\n";
  return text.str() + more;
}

/// Hexahedra, voxels (another order of points), linear Lagrange ones, one with further points; cell data go with the parts.
TEST(Element, VtkFilesOfHexahedra) {
  const Volumes volumes = grid({2, 1, 2}, ascending(18));
  const TetMesh expected = split(volumes);
  const std::string data = "CELL_DATA 4\nSCALARS part int\nLOOKUP_TABLE default\n5 6 7 8\n";
  for (const int type : {12, 72, 79}) expectSameMesh(loadBytes(vtkText(volumes, std::vector<int>(4, type))), expected);
  Volumes voxels = volumes;
  for (std::vector<int>& voxel : voxels.elements) {
    std::swap(voxel[2], voxel[3]);
    std::swap(voxel[6], voxel[7]);
  }
  const FileOfBytes file(vtkText(voxels, {11, 11, 11, 11}, data));
  MeshLabels labels;
  std::string said;
  MeshPreparation preparation;
  preparation.say = [&](const std::string& line) { said += line; };
  expectSameMesh(loadTetMesh(meshFile(file.path()), preparation, &labels), expected);
  EXPECT_NE(said.find("4 of 4 elements are hexahedra, prisms or pyramids, and split into tetrahedra"),
            std::string::npos)
      << said;
  ASSERT_EQ(labels.volume_of.size(), 24U);
  for (std::size_t i = 0; i < 24; ++i) {
    const std::size_t cell = i / 6;
    EXPECT_EQ(labels.cell_data.at(0).values.at(labels.volume_of[i]), 5.0 + static_cast<double>(cell));
  }
  Volumes quadratic = volumes;
  quadratic.nodes.conservativeResize(Eigen::NoChange, 30);
  for (int i = 18; i < 30; ++i) {
    quadratic.nodes.col(i) = Vector3(i, 0.5, 0.5);
    quadratic.elements[3].push_back(i);
  }
  expectSameMesh(loadBytes(vtkText(quadratic, {12, 12, 12, 25})), expected);
}

struct Shape {
  std::vector<Vector3> corners;  ///< in the order of both formats
  double volume;
};

const Shape kTetrahedron = {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}}, 1.0 / 6.0};
const Shape kPyramid = {{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0.5, 0.5, 1}}, 1.0 / 3.0};
const Shape kPrism = {{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {0, 1, 1}}, 0.5};
const Shape kHexahedron = {{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}, {0, 0, 1}, {1, 0, 1}, {1, 1, 1}, {0, 1, 1}},
                           1.0};

struct Kind {
  int type;
  std::size_t nodes;
  const Shape* shape;
};

/// Of one element, its further nodes somewhere else.
NodalVectors nodesOf(const Kind& kind) {
  NodalVectors nodes(3, static_cast<Eigen::Index>(kind.nodes));
  for (std::size_t i = 0; i < kind.nodes; ++i) {
    const auto further = static_cast<double>(i);
    nodes.col(static_cast<Eigen::Index>(i)) =
        i < kind.shape->corners.size() ? kind.shape->corners[i] : Vector3(0.1, 0.2, 10.0 + further);
  }
  return nodes;
}

void expectShape(const TetMesh& mesh, const Kind& kind) {
  EXPECT_EQ(static_cast<std::size_t>(mesh.positions.cols()), kind.shape->corners.size());
  expectSound(mesh, kind.shape->volume);
}

/// Gmsh's table of elements ("MSH file format").
TEST(Element, EveryVolumeOfGmsh) {
  const Kind kinds[] = {{4, 4, &kTetrahedron},   {5, 8, &kHexahedron},   {6, 6, &kPrism},     {7, 5, &kPyramid},
                        {11, 10, &kTetrahedron}, {12, 27, &kHexahedron}, {13, 18, &kPrism},   {14, 14, &kPyramid},
                        {17, 20, &kHexahedron},  {18, 15, &kPrism},      {19, 13, &kPyramid}, {29, 20, &kTetrahedron},
                        {30, 35, &kTetrahedron}, {31, 56, &kTetrahedron}};
  for (const Kind& kind : kinds) {
    SCOPED_TRACE(kind.type);
    const NodalVectors nodes = nodesOf(kind);
    std::ostringstream text;
    text << "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n" << kind.nodes << "\n";
    for (std::size_t i = 0; i < kind.nodes; ++i)
      text << i + 1 << " " << nodes.col(static_cast<Eigen::Index>(i)).transpose() << "\n";
    text << "$EndNodes\n$Elements\n1\n1 " << kind.type << " 2 0 1";
    for (std::size_t i = 0; i < kind.nodes; ++i) text << " " << i + 1;
    text << "\n$EndElements\n";
    expectShape(loadBytes(text.str()), kind);
  }
}

/// vtkCellType.h; Lagrange and Bezier ones of any order.
TEST(Element, EveryVolumeOfVtk) {
  const Kind kinds[] = {{10, 4, &kTetrahedron}, {12, 8, &kHexahedron},   {13, 6, &kPrism},
                        {14, 5, &kPyramid},     {24, 10, &kTetrahedron}, {25, 20, &kHexahedron},
                        {26, 15, &kPrism},      {27, 13, &kPyramid},     {29, 27, &kHexahedron},
                        {31, 12, &kPrism},      {32, 18, &kPrism},       {33, 24, &kHexahedron},
                        {37, 19, &kPyramid},    {71, 4, &kTetrahedron},  {72, 12, &kHexahedron},
                        {73, 6, &kPrism},       {74, 14, &kPyramid},     {78, 20, &kTetrahedron},
                        {79, 8, &kHexahedron},  {80, 18, &kPrism},       {81, 5, &kPyramid}};
  for (const Kind& kind : kinds) {
    SCOPED_TRACE(kind.type);
    Volumes volumes{nodesOf(kind), {ascending(kind.nodes)}};
    if (kind.type == 13)
      std::swap_ranges(volumes.elements[0].begin(), volumes.elements[0].begin() + 3, volumes.elements[0].begin() + 3);
    const FileOfBytes file(vtkText(volumes, {kind.type}));
    std::string said;
    MeshPreparation preparation;
    preparation.say = [&](const std::string& line) { said += line; };
    expectShape(loadTetMesh(meshFile(file.path()), preparation), kind);
    EXPECT_EQ(said.find("numbered the other way round"), std::string::npos) << said;
  }
}

/// A side bent so far that it is concave, and a corner in the middle of a side.
TEST(Element, WhatCannotBeSplitIsNamed) {
  Volumes volumes = grid({2, 1, 1}, ascending(12));
  volumes.nodes.col(2) = Vector3(1.4, 0.6, 0.0);
  expectRefused(vtkText(volumes, {12, 12}),
                {"volume element 1 (0-based, in file order), a hexahedron", "so far from convex", "inverted"});
  volumes.nodes.col(2) = Vector3(1.5, 0.5, 0.0);
  expectRefused(vtkText(volumes, {12, 12}), {"volume element 1 ", "flat or inverted"});
  volumes.elements = {std::vector<int>(8, 3)};
  expectRefused(vtkText(volumes, {12}), {"all of its volumes have collapsed"});
}

/// Before they are split.
TEST(Element, MoreThanASceneMayHaveAreRefused) {
  Volumes volumes = grid({1, 1, 1}, ascending(8));
  volumes.elements.assign(kMostElements / 6 + 1, volumes.elements[0]);
  expectRefused(vtkText(volumes, std::vector<int>(volumes.elements.size(), 12)),
                {"makes 2000004 tetrahedra; at most 2000000"});
}

/// Numbered from the other side.
TEST(Element, MirroredOnesAreTurned) {
  Volumes volumes = grid({2, 1, 1}, ascending(12));
  for (std::vector<int>& element : volumes.elements)
    std::swap_ranges(element.begin(), element.begin() + 4, element.begin() + 4);
  expectSound(loadBytes(vtkText(volumes, {12, 12})), 2.0);
}

/// A group of quadrangles holds the nodes of its side, one of hexahedra their tetrahedra.
TEST(Element, GmshGroupsOfHexahedra) {
  const std::string text =
      "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n2\n2 1 \"base\"\n3 2 "
      "\"tumour\"\n$EndPhysicalNames\n$Nodes\n12\n"
      "1 0 0 0\n2 1 0 0\n3 1 1 0\n4 0 1 0\n5 0 0 1\n6 1 0 1\n7 1 1 1\n8 0 1 1\n9 0 0 2\n10 1 0 2\n11 1 1 2\n12 0 1 "
      "2\n$EndNodes\n"
      "$Elements\n3\n1 3 2 1 1 1 4 3 2\n2 5 2 0 1 1 2 3 4 5 6 7 8\n3 5 2 2 1 5 6 7 8 9 10 11 12\n$EndElements\n";
  const FileOfBytes file(text);
  MeshLabels labels;
  const TetMesh mesh = loadTetMesh(meshFile(file.path()), {}, &labels);
  expectSound(mesh, 2.0);
  const auto held = [&](const char* group) {
    const std::vector<bool> nodes =
        fixedNodes(mesh.positions, withPlaces({GroupRegion{group}}, labels, mesh, "fixed", "tissue"), "tissue");
    return std::count(nodes.begin(), nodes.end(), true);
  };
  EXPECT_EQ(held("base"), 4);
  EXPECT_EQ(held("tumour"), 8);
  const auto regions = withPlaces({GroupRegion{"tumour"}}, labels, mesh, "where", "tissue");
  int inside = 0;
  for (const Tetrahedron& tet : mesh.tetrahedra) {
    Vector3 sum = Vector3::Zero();
    for (const int node : tet) sum += mesh.positions.col(node);
    inside += anyHolds(regions, sum / 4.0, 1e-9) ? 1 : 0;
  }
  EXPECT_EQ(inside, 6);
}

}  // namespace element_test
}  // namespace tissue_contact
