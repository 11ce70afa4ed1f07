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
    return number[static_cast<std::size_t>(i + (cells[0] + 1) * (j + (cells[1] + 1) * k))];
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
    for (int i = 0; i < 13; ++i)
      volumes.nodes.col(number[static_cast<std::size_t>(i)]) = Vector3(i % 2, i / 2 % 2, i / 4);
    volumes.nodes.col(number[12]) = Vector3(0.5, 0.5, 0.5);
    const auto at = [&](int i, int j, int k) { return number[static_cast<std::size_t>(i + 2 * j + 4 * k)]; };
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

/// A hexahedron of which one edge has no length, as mesh generators write prisms, and one side: nothing flat is left.
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
  ASSERT_EQ(labels.cell_data.at(0).values.size(), 24U);
  for (std::size_t i = 0; i < 24; ++i) EXPECT_EQ(labels.cell_data[0].values[i], 5.0 + static_cast<double>(i / 6));
  Volumes quadratic = volumes;
  quadratic.nodes.conservativeResize(Eigen::NoChange, 30);
  for (int i = 18; i < 30; ++i) {
    quadratic.nodes.col(i) = Vector3(i, 0.5, 0.5);
    quadratic.elements[3].push_back(i);
  }
  expectSameMesh(loadBytes(vtkText(quadratic, {12, 12, 12, 25})), expected);
}

/// Numbered from the other side, as VTK has its wedges.
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
