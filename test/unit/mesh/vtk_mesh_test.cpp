/// @file
/// Legacy VTK files: every version and encoding gives the same mesh; what is wrong with a file is named with its place.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "mesh/labels.h"
#include "mesh_writers.h"

namespace tissue_contact {
namespace vtk_mesh_test {

/// A triangle and two tetrahedra on five points. Lines are counted in the tests below.
const char* const kText3 =
    "# vtk DataFile Version 3.0\ntwo tetrahedra\nASCII\nDATASET UNSTRUCTURED_GRID\n"  // 1 to 4
    "POINTS 5 float\n0 0 0\n1 0 0\n0 1 0\n0 0 1 1 1 1\n"                              // 5 to 9
    "CELLS 3 14\n3 0 1 2\n4 0 1 2 3\n4 1 2 3 4\n"                                     // 10 to 13
    "CELL_TYPES 3\n5\n10\n10\n";                                                      // 14 to 17

const char* const kText5 =
    "# vtk DataFile Version 5.1\ntwo tetrahedra\nASCII\nDATASET UNSTRUCTURED_GRID\n"  // 1 to 4
    "POINTS 5 double\n0 0 0\n1 0 0\n0 1 0\n0 0 1 1 1 1\n"                             // 5 to 9
    "CELLS 4 11\nOFFSETS vtktypeint64\n0 3 7 11\n"                                    // 10 to 12
    "CONNECTIVITY vtktypeint64\n0 1 2 0 1 2 3\n1 2 3 4\n"                             // 13 to 15
    "CELL_TYPES 3\n5\n10\n10\n";                                                      // 16 to 19

std::vector<VtkStyle> allStyles() {
  std::vector<VtkStyle> styles;
  for (const char* version : {"2.0", "3.0", "4.2", "5.0", "5.1"}) {
    for (const bool binary : {false, true}) {
      for (const unsigned real_bytes : {4U, 8U}) {
        for (const unsigned offset_bytes : {4U, 8U}) {
          for (const bool extras : {false, true}) styles.push_back({version, binary, real_bytes, offset_bytes, extras});
        }
      }
    }
  }
  return styles;
}

TEST(VtkMesh, TextOfBothLayouts) {
  expectSameMesh(loadBytes(kText3), twoTetrahedra());
  expectSameMesh(loadBytes(kText5), twoTetrahedra());
}

TEST(VtkMesh, EveryVersionEncodingAndTypeAgrees) {
  const TetMesh mesh = loadTetMesh(meshFile(fixturePath("box_v2_binary.vtk")));
  TetMesh rounded = mesh;
  rounded.positions = mesh.positions.cast<float>().cast<double>();
  for (const VtkStyle& style : allStyles()) {
    SCOPED_TRACE(std::string(style.version) + (style.binary ? " binary " : " text ") +
                 std::to_string(style.real_bytes));
    const bool single = style.binary && style.real_bytes == 4;  // text keeps its digits whatever type it announces
    expectSameMesh(loadBytes(VtkWriter(style).write(mesh)), single ? rounded : mesh);
  }
}

TEST(VtkMesh, GmshFilesAgreeWithItsMshFiles) {
  const TetMesh expected = loadTetMesh(meshFile(fixturePath("box_v22_binary.msh")));
  expectSameMesh(loadTetMesh(meshFile(fixturePath("box_v2_binary.vtk"))), expected);
  const TetMesh text = loadTetMesh(meshFile(fixturePath("box_v2.vtk")));
  ASSERT_EQ(text.positions.cols(), expected.positions.cols());
  EXPECT_LT((text.positions - expected.positions).cwiseAbs().maxCoeff(), 1e-15);  // 16 digits
  EXPECT_EQ(text.tetrahedra, expected.tetrahedra);
}

TEST(VtkMesh, EveryPrefixUpToTheCellTypesIsRefused) {
  for (VtkStyle style : allStyles()) {
    style.extras = false;
    const std::string whole = VtkWriter(style).write(twoTetrahedra());
    const FileOfBytes file(whole);  // one for all: twenty thousand folders of their own make some file systems wait
    const auto load = [&] { loadTetMesh(meshFile(file.path())); };
    ASSERT_NO_THROW(load());
    // In text the last type, "10 ", is complete without its last byte; without the last two it is another number.
    for (std::size_t size = 0; size + 1 < whole.size(); ++size) {
      const std::string part = whole.substr(0, size);
      if (!style.binary && size + 2 == whole.size()) continue;
      file.write(part);
      ASSERT_THROW(load(), std::invalid_argument) << style.version << ": " << size << " of " << whole.size();
    }
  }
}

TEST(VtkMesh, NamesTheHeaderThatIsWrong) {
  expectRefused(replaced(kText3, "Version 3.0", "Version 6.0"), {":1: ", "Version 6.0", "1.0 to 5.x"});
  expectRefused(replaced(kText3, "Version 3.0", "Version"), {":1: ", "legacy VTK"});
  expectRefused(replaced(kText3, "ASCII", "BASE64"), {":3: expected ASCII or BINARY, found 'BASE64'"});
  expectRefused(replaced(kText3, "DATASET", "DATA"), {":4: expected DATASET"});
  expectRefused(replaced(kText3, "UNSTRUCTURED_GRID", "POLYDATA"),
                {":4: the data set is 'POLYDATA'", "gmsh FILE.vtk -save -o FILE.stl", "make_scene.py"});
  expectRefused(replaced(kText3, "UNSTRUCTURED_GRID", "STRUCTURED_POINTS"), {"'STRUCTURED_POINTS'", "mesh the volume"});
}

TEST(VtkMesh, NamesBlocksThatAreMissingOrRepeated) {
  expectRefused(replaced(kText3, "CELLS 3", "CELL_DATA 3"),
                {":10: expected POINTS, CELLS or CELL_TYPES, found 'CELL_DATA'"});
  expectRefused(replaced(kText3, "CELLS 3 14\n", "POINTS 0 float\nCELLS 3 14\n"), {":10: a second block POINTS"});
  expectRefused("# vtk DataFile Version 3.0\n\nASCII\nDATASET UNSTRUCTURED_GRID\nCELL_TYPES 0\n",
                {":5: CELL_TYPES must follow"});
  expectRefused(replaced(kText3, "CELL_TYPES 3", ""), {":15: expected POINTS", "'5'"});
}

TEST(VtkMesh, NamesCountsThatDoNotFit) {
  expectRefused(replaced(kText3, "POINTS 5", "POINTS 4"), {":9: ", "found '1'", "longer than its count"});
  expectRefused(replaced(kText3, "POINTS 5", "POINTS 6"), {":10: expected a node's x", "'CELLS'"});
  expectRefused(replaced(kText3, "POINTS 5", "POINTS -5"), {":5: the number of points is -5"});
  expectRefused(replaced(kText3, "POINTS 5", "POINTS 4611686018427387904"),
                {":5: the number of points is 4611686018427387904"});
  expectRefused(replaced(kText3, "CELLS 3 14", "CELLS 3 15"), {":14: ", "'CELL_TYPES'"});
  expectRefused(replaced(kText3, "CELLS 3 14", "CELLS 2 14"), {":13: CELLS has 5 values more"});
  expectRefused(replaced(kText3, "CELLS 3 14", "CELLS 4 14"), {"cell 3 lies behind the 14 values"});
  expectRefused(replaced(kText3, "CELLS 3 14", "CELLS 3 2000000000"),
                {":10: the number of values of CELLS is 2000000000"});
  expectRefused(replaced(kText3, "4 1 2 3 4", "5 1 2 3 4"), {":13: cell 2 has 5 points"});
  expectRefused(replaced(kText3, "4 1 2 3 4", "-4 1 2 3 4"), {":13: cell 2 has -4 points"});
  expectRefused(replaced(kText3, "CELL_TYPES 3", "CELL_TYPES 2"), {":14: there are 2 cell types for 3 cells"});
}

TEST(VtkMesh, NamesOffsetsThatDoNotFit) {
  expectRefused(replaced(kText5, "0 3 7 11", "1 3 7 11"), {":12: offset 0 is 1"});
  expectRefused(replaced(kText5, "0 3 7 11", "0 3 2 11"), {":12: offset 2 is 2"});
  expectRefused(replaced(kText5, "0 3 7 11", "0 3 12 11"), {":12: offset 2 is 12"});
  expectRefused(replaced(kText5, "0 3 7 11", "0 3 7 10"), {":12: offset 3 is 10"});
  expectRefused(replaced(kText5, "0 3 7 11", "0 3 -7 11"), {":12: offset 2 is -7"});
  expectRefused(replaced(kText5, "CELLS 4 11", "CELLS 0 11"), {":12: ", "found '0'"});
  expectRefused(replaced(replaced(kText5, "CELLS 4 11", "CELLS 0 11"), "0 3 7 11\n", ""), {"no OFFSETS"});
  expectRefused(replaced(kText5, "OFFSETS vtktypeint64", "OFFSETS float"), {":11: ", "'FLOAT'"});
  expectRefused(replaced(kText5, "CONNECTIVITY", "CONNECT"), {":13: expected CONNECTIVITY"});
  expectRefused(replaced(kText3, "Version 3.0", "Version 5.1"), {":11: expected OFFSETS"});
}

TEST(VtkMesh, NamesValuesThatAreWrong) {
  expectRefused(replaced(kText3, "POINTS 5 float", "POINTS 5 half"), {":5: ", "float or double", "'HALF'"});
  expectRefused(replaced(kText3, "\n0 1 0\n", "\n0 nan 0\n"), {":8: node 2 ", "finite"});
  expectRefused(replaced(kText3, "\n0 1 0\n", "\n0 x 0\n"), {":8: expected a node's y", "'x'"});
  expectRefused(replaced(kText3, "4 1 2 3 4", "4 1 2 3 5"), {":13: cell 2 refers to point 5", "5 points"});
  expectRefused(replaced(kText3, "4 1 2 3 4", "4 1 2 3 -1"), {":13: cell 2 refers to point -1"});
  expectRefused(replaced(kText5, "1 2 3 4", "1 2 3 9223372036854775807"),
                {":15: cell 2 refers to point 9223372036854775807"});
  expectRefused(replaced(kText3, "\n5\n10\n", "\n10\n10\n"),
                {":15: cell 0 has the type 10 and 3 points; it must have 4, or 10"});
  expectRefused(replaced(kText3, "\n5\n10\n10", "\n5\n10\n12"),
                {":17: cell 2 has the type 12 and 4 points; it must have 8, or 20"});
}

/// What may fill space and cannot be split here would leave holes: polyhedra, sets of points, types that nobody knows.
TEST(VtkMesh, OtherVolumesAreRefusedBesideTetrahedra) {
  for (const char* type : {"15", "16", "41", "42", "55", "64", "67", "82", "-7"}) {
    expectRefused(replaced(kText3, "\n5\n10\n10", "\n" + std::string(type) + "\n10\n10"),
                  {"holds 1 polyhedra or other cells", "split them into tetrahedra"});
  }
  for (const char* type : {"0", "7", "9", "22", "28", "30", "34", "36", "51", "61", "69", "77"}) {
    expectSameMesh(loadBytes(replaced(kText3, "\n5\n10\n10", "\n" + std::string(type) + "\n10\n10")), twoTetrahedra());
  }
}

/// DOLFINx calls its tetrahedra so, whatever their order.
TEST(VtkMesh, LagrangeTetrahedraMayBeOfFirstOrder) {
  for (const char* type : {"71", "78"}) {
    expectSameMesh(loadBytes(replaced(kText3, "\n5\n10\n10", "\n5\n10\n" + std::string(type))), twoTetrahedra());
  }
}

/// Quadratic, Lagrange and Bezier ones; the nodes between corners are gone.
TEST(VtkMesh, TetrahedraOfHigherOrderAreTakenByTheirCorners) {
  const std::string text =
      "# vtk DataFile Version 3.0\nof ten\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 11 float\n1 0 0 0 0 0 2 0 0 0 2 0 "
      "0 0 2\n"
      "1 1 0 0 1 0 0 0 1 0 1 1 1 0 1 3 3 3\nCELLS 2 16\n10 1 2 3 4 0 5 6 7 8 9\n4 2 3 5 10\nCELL_TYPES 2\nKIND\n10\n"
      "CELL_DATA 2\nSCALARS part int\nLOOKUP_TABLE default\n7 8\n";
  for (const char* type : {"24", "71", "78"}) {
    const TetMesh mesh = loadBytes(replaced(text, "KIND", type));
    EXPECT_EQ(mesh.positions.cols(), 6);
    EXPECT_EQ(mesh.tetrahedra, (std::vector<Tetrahedron>{{0, 1, 2, 3}, {1, 2, 4, 5}}));
    EXPECT_EQ(Vector3(mesh.positions.col(4)), Vector3(1.0, 1.0, 0.0));
    const FileOfBytes file(replaced(text, "KIND", type));
    MeshLabels labels;
    loadTetMesh(meshFile(file.path()), {}, &labels);
    EXPECT_EQ(labels.cell_data.at(0).values, (std::vector<double>{7.0, 8.0}));
  }
  expectRefused(replaced(replaced(text, "KIND", "24"), "5 6 7 8 9\n", "5 6 7 8 11\n"), {"cell 0 refers to point 11"});
}

TEST(VtkMesh, BinaryPlacesAreBytes) {
  const std::string bytes = VtkWriter({"5.1", true, 8, 8, false}).write(twoTetrahedra());
  const std::size_t last_point = bytes.find("\nCELL_TYPES") - 8;
  std::string bad = bytes;
  bad.replace(last_point, 8, ByteWriter(true).integer(-3, 8).bytes());
  expectRefused(bad, {"byte " + std::to_string(last_point) + ": cell 2 refers to point -3"});
}

TEST(VtkMesh, FieldDataThatCannotBeSkippedIsNamed) {
  const auto with_field = [](const std::string& field) { return replaced(kText3, "POINTS", field + "POINTS"); };
  EXPECT_NO_THROW(loadBytes(with_field("FIELD FieldData 1\nTIME 1 1 double\n0.5\n")));
  expectRefused(with_field("FIELD FieldData 1\nname 1 1 string\nx\n"), {":6: ", "'STRING'", "without field data"});
  expectRefused(with_field("FIELD FieldData 1\nname 40 40 int\n1\n"), {"values of an array is 1600"});
  expectRefused(with_field("FIELD FieldData 99999\n"), {":5: the number of field arrays is 99999"});
}

/// As VTK's own writer has it: METADATA behind any array, with an empty line for a component without a name; arrays that are not there.
TEST(VtkMesh, WhatVtkWritesBesideArraysIsSkipped) {
  const std::string named = "METADATA\nCOMPONENT_NAMES\nX\n\nZ\nINFORMATION 0\n\n";
  expectSameMesh(loadBytes(replaced(kText3, "CELLS", named + "CELLS")), twoTetrahedra());
  expectSameMesh(loadBytes(replaced(kText5, "CONNECTIVITY", "METADATA\nINFORMATION 0\n\nCONNECTIVITY")),
                 twoTetrahedra());
  const std::string one = "FIELD FieldData 1\nseconds 1 1 double\n0.5\nMETADATA\nCOMPONENT_NAMES\ns\nINFORMATION 0\n\n";
  expectSameMesh(loadBytes(replaced(kText3, "POINTS", one + "POINTS")), twoTetrahedra());
  const std::string field = "FIELD FieldData 3\nfirst 1 1 signed_char\n5\nNULL_ARRAY\nlast 2 1 unsigned_char\n1 2\n";
  expectSameMesh(loadBytes(replaced(kText3, "POINTS", field + "POINTS")), twoTetrahedra());
}

}  // namespace vtk_mesh_test
}  // namespace tissue_contact
