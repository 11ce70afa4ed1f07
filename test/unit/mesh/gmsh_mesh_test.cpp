/// @file
/// Gmsh MSH files: every version and encoding gives the same mesh; what is wrong with a file is named with its place.
#include <gtest/gtest.h>

#include <string>

#include "mesh/labels.h"
#include "mesh_writers.h"

namespace tissue_contact {
namespace gmsh_mesh_test {

/// Six nodes with sparse, unordered tags; a point, a triangle and two tetrahedra. Lines are counted in the tests below.
const char* const kText1 =
    "$NOD\n5\n70 0 0 0\n2000000000 1 0 0\n3 0 1 0\n41 0 0 1\n5 1. +1.0 1e0\n$ENDNOD\n"   // 1 to 8
    "$ELM\n4\n1 15 0 1 1 70\n2 2 0 1 3 70 2000000000 3\n9 4 7 1 4 70 2000000000 3 41\n"  // 9 to 13
    "8 4 7 1 4 2000000000 3 41 5\n$ENDELM\n";                                            // 14 to 15

const char* const kText22 =
    "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n"                                                  // 1 to 3
    "$Comments\nanything $Nodes\n$EndComments\n"                                              // 4 to 6
    "$Nodes\n5\n70 0 0 0\n2000000000 1 0 0\n3 0 1 0\n41 0 0 1\n5 1. +1.0 1e0\n$EndNodes\n"    // 7 to 14
    "$Elements\n4\n1 15 2 0 1 70\n2 2 2 0 1 70 2000000000 3\n9 4 2 7 1 70 2000000000 3 41\n"  // 15 to 19
    "8 4 4 7 1 1 1 2000000000 3 41 5\n$EndElements\n";                                        // 20 to 21

const char* const kText40 =
    "$MeshFormat\n4 0 8\n$EndMeshFormat\n"  // 1 to 3
    "$Nodes\n2 5\n1 1 1 2\n70 0 0 0 0.5\n2000000000 1 0 0 0.6\n1 3 0 3\n3 0 1 0\n41 0 0 1\n5 1 1 1\n$EndNodes\n"
    "$Elements\n2 3\n1 0 15 1\n1 70\n1 3 4 2\n9 70 2000000000 3 41\n8 2000000000 3 41 5\n$EndElements\n";

const char* const kText41 =
    "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n"                                                       // 1 to 3
    "$Nodes\n2 5 3 9000000000000000001\n1 1 1 2\n70\n9000000000000000001\n0 0 0 0.5\n1 0 0 0.6\n"  // 4 to 10
    "3 1 0 3\n3\n41\n5\n0 1 0\n0 0 1\n1 1 1\n$EndNodes\n"                                          // 11 to 18
    "$Elements\n2 3 1 9\n0 1 15 1\n1 70\n3 1 4 2\n9 70 9000000000000000001 3 41\n"                 // 19 to 24
    "8 9000000000000000001 3 41 5\n$EndElements\n";                                                // 25 to 26

TEST(GmshMesh, TextOfEveryVersionWithSparseTags) {
  for (const char* text : {kText1, kText22, kText40, kText41}) expectSameMesh(loadBytes(text), twoTetrahedra());
}

TEST(GmshMesh, LineEndsAndSpacesDoNotMatterInText) {
  std::string text;
  for (const char* c = kText41; *c != '\0'; ++c) text += *c == '\n' ? "\r\n" : *c == ' ' ? " \t " : std::string(1, *c);
  expectSameMesh(loadBytes(text), twoTetrahedra());
}

TEST(GmshMesh, GmshFilesOfEveryVersionAndEncodingAgree) {
  const TetMesh mesh = loadTetMesh(meshFile(fixturePath("box_v22.msh")));
  EXPECT_EQ(mesh.positions.cols(), 62);
  EXPECT_EQ(mesh.tetrahedra.size(), 144U);
  EXPECT_NO_THROW(checkTetMesh(mesh, "box"));
  EXPECT_NEAR(totalVolume(mesh), 2.0, 1e-12);  // 2 x 1 x 1
  EXPECT_TRUE(mesh.positions.col(2) == Vector3(2, 1, 0));
  EXPECT_TRUE(mesh.positions.rowwise().maxCoeff() == Vector3(2, 1, 1));
  EXPECT_TRUE(mesh.positions.rowwise().minCoeff() == Vector3(0, 0, 0));
  for (const char* name :
       {"box_v1.msh", "box_v22_binary.msh", "box_v40_parametric.msh", "box_v41.msh", "box_v41_binary_parametric.msh"}) {
    SCOPED_TRACE(name);
    const TetMesh other = loadTetMesh(meshFile(fixturePath(name)));
    ASSERT_EQ(other.positions.cols(), mesh.positions.cols());
    // Text has 16 digits, one less than a double needs.
    EXPECT_LT((other.positions - mesh.positions).cwiseAbs().maxCoeff(), 1e-15);
    EXPECT_EQ(other.tetrahedra, mesh.tetrahedra);
  }
}

TEST(GmshMesh, BinaryOfEveryVersionInBothByteOrders) {
  const TetMesh mesh = loadTetMesh(meshFile(fixturePath("box_v22_binary.msh")));
  for (const bool big_endian : {false, true}) {
    expectSameMesh(loadBytes(msh22Binary(mesh, big_endian)), mesh);
    expectSameMesh(loadBytes(msh4Binary(mesh, big_endian, false)), mesh);
    expectSameMesh(loadBytes(msh4Binary(mesh, big_endian, true)), mesh);
  }
}

/// As Gmsh writes them; the nodes between corners are gone, those that nothing refers to stay an error.
TEST(GmshMesh, TetrahedraOfHigherOrderAreTakenByTheirCorners) {
  MeshPreparation preparation;
  std::string said;
  preparation.say = [&](const std::string& line) { said += line; };
  const TetMesh mesh = loadTetMesh(meshFile(fixturePath("box_v41_binary_order2.msh")), preparation);
  checkTetMesh(mesh, "box");
  const TetMesh linear = loadTetMesh(meshFile(fixturePath("box_v41.msh")));
  EXPECT_EQ(mesh.positions.cols(), 14);
  double volume = 0.0;
  for (const Tetrahedron& tet : mesh.tetrahedra) volume += signedVolume(mesh.positions, tet);
  double expected = 0.0;
  for (const Tetrahedron& tet : linear.tetrahedra) expected += signedVolume(linear.positions, tet);
  EXPECT_NEAR(volume, expected, 1e-14);  // of the same box
  EXPECT_NE(said.find("24 of 24 elements are of higher order"), std::string::npos);

  // One quadratic tetrahedron, a second that is linear and shares one of its middle nodes as a corner, and a node of nothing.
  const std::string text =
      "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n12\n1 0 0 0\n2 2 0 0\n3 0 2 0\n4 0 0 2\n5 1 0 0\n6 1 1 0\n7 0 1 "
      "0\n"
      "8 0 0 1\n9 0 1 1\n10 1 0 1\n11 3 3 3\n12 9 9 9\n$EndNodes\n$Elements\n2\n1 11 2 0 1 1 2 3 4 5 6 7 8 9 10\n"
      "2 4 2 0 1 2 3 6 11\n$EndElements\n";
  const TetMesh mixed = loadBytes(text);
  EXPECT_EQ(mixed.positions.cols(), 7);  // four corners, 6, 11 and 12
  EXPECT_EQ(mixed.tetrahedra, (std::vector<Tetrahedron>{{0, 1, 2, 3}, {1, 2, 4, 5}}));
  EXPECT_EQ(Vector3(mixed.positions.col(4)), Vector3(1.0, 1.0, 0.0));
  expectRefused(replaced(text, "5 6 7 8 9 10", "5 6 7 8 9 13"),
                {"element 1 refers to node tag 13, which $Nodes does not define"});
  expectRefused(replaced(kText22, "8 4 4", "8 71 4"), {":20: element 8 has the type 71", "linear elements"});
}

/// A section of capitals that is not of MSH 1 ends as all others.
TEST(GmshMesh, SectionsOfCapitalsAreSkipped) {
  const std::string meta = "$META\nof no interest\n$EndMETA\n";
  expectSameMesh(loadBytes(replaced(kText22, "$Elements", meta + "$Elements")), twoTetrahedra());
}

/// Where an element has one group, Gmsh writes it once for each; twice in one group it is there twice.
TEST(GmshMesh, ElementsOfSeveralGroupsAreOne) {
  const std::string twice = replaced(replaced(kText22, "$Elements\n4", "$Elements\n5"), "$EndElements",
                                     "10 4 2 77 1 2000000000 3 41 5\n$EndElements");
  expectSameMesh(loadBytes(twice), twoTetrahedra());
  const FileOfBytes file(twice);
  MeshLabels labels;
  expectSameMesh(loadTetMesh(meshFile(file.path()), {}, &labels), twoTetrahedra());
  EXPECT_EQ(labels.groups.back().number, 77);
  EXPECT_EQ(labels.groups.back().elements.size(), 1u);
  const TetMesh same = loadBytes(replaced(twice, "10 4 2 77 1", "10 4 2 7 1"));
  expectRefusal([&] { checkTetMesh(same, "mesh"); }, {"has the same four nodes as tetrahedron"});
}

TEST(GmshMesh, EveryPrefixOfAFileIsRefused) {
  const TetMesh mesh = twoTetrahedra();
  for (const std::string& whole :
       {std::string(kText1), std::string(kText22), std::string(kText40), std::string(kText41), msh22Binary(mesh, false),
        msh4Binary(mesh, false, false), msh4Binary(mesh, true, true)}) {
    const FileOfBytes file(whole);  // one for all: thousands of folders of their own make some file systems wait
    const auto load = [&] { loadTetMesh(meshFile(file.path())); };
    ASSERT_NO_THROW(load());
    // All but the newline at the very end is needed.
    for (std::size_t size = 0; size + 1 < whole.size(); ++size) {
      file.write(whole.substr(0, size));
      ASSERT_THROW(load(), std::invalid_argument) << size << " of " << whole.size();
    }
  }
}

TEST(GmshMesh, NamesTheFormatThatIsNotRead) {
  expectRefused("$NODES\n1\n", {":1: ", "$NOD of MSH 1", "'$NODES'", "gmsh -save -format msh41"});
  expectRefused("MESH dimension 3 ElemType Tetrahedra Nnode 4\n", {":1: ", "'MESH dimension 3", "GiD"});
  for (const char* version : {"1", "2.3", "3", "4.2", "5", "x", "-2.2", "nan"}) {
    expectRefused(replaced(kText22, "2.2 0", std::string(version) + " 0"), {":2: MSH version '", version, "msh41"});
  }
  expectRefused(replaced(kText22, "2.2 0", "2.2 2"), {":2: the file type is 2"});
  expectRefused(replaced(kText22, "2.2 0 8", "2.2 0 8 9"), {":2: unexpected ' 9' at the end of the line"});
  expectRefused(replaced(kText22, "$EndMeshFormat", "$EndFormat"), {":3: expected $EndMeshFormat"});
  expectRefused("$MeshFormat\n4.1 1 4\n", {"the data size is 4 bytes", "64-bit"});
  expectRefused("$MeshFormat\n2.2 1 8\n\n\n\n\n", {"byte 20", "byte order", "copy it again"});
}

TEST(GmshMesh, NamesSectionsThatAreWrong) {
  expectRefused(replaced(replaced(kText22, "$Nodes\n5", "$ParametricNodes\n5"), "$EndNodes", "$EndParametricNodes"),
                {":7: $ParametricNodes is not read", "Mesh.SaveParametric"});
  expectRefused(std::string(kText22) + "$Nodes\n0\n$EndNodes\n", {":22: a second section $Nodes"});
  expectRefused("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Elements\n0\n$EndElements\n", {":4: $Elements comes before"});
  expectRefused("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n",
                {"without a $Elements section", "Gmsh made no mesh", "truncated"});
  expectRefused(std::string(kText22) + "garbage", {":22: expected a section", "'garbage'"});
  for (const char* text : {kText1, kText22}) {  // to search for the end of such a section would take hours
    expectRefused(text + ("$" + std::string(1000, 'N')) + "\n", {"expected a section", "'$NNN", "...'"});
  }
  expectRefused(std::string(kText22) + "$NodeData\n1\n", {":22: no $EndNodeData follows"});
  expectRefused(replaced(kText22, "$EndNodes", "$EndNode"), {":14: expected $EndNodes, found '$EndNode'"});
}

TEST(GmshMesh, NamesWhatIsWrongInTheFirstFormat) {
  const std::string text(kText1);
  expectRefused(replaced(text, "$NOD\n5", "$NOD\n4000000000"), {":2: the number of nodes is 4000000000", "truncated"});
  expectRefused(replaced(text, "$ENDNOD", "$EndNodes"), {":8: expected $ENDNOD, found '$EndNodes'"});
  expectRefused(text + "$NOD\n0\n$ENDNOD\n", {":16: a second section $NOD"});
  expectSameMesh(loadBytes(text + "$Periodic\n0\n$EndPeriodic\n"), loadBytes(text));  // as Gmsh 4.8 writes it
  expectRefused(text.substr(0, text.find("$ELM")), {"without a $ELM section", "truncated"});
  expectRefused(text.substr(text.find("$ELM")), {":1: ", "$NOD of MSH 1", "'$ELM'"});
  expectRefused("$NOD\n0\n$ENDNOD\n$NOD2\n", {":4: no $EndNOD2 follows"});
  expectRefused(replaced(text, "$ELM\n4", "$ELM\n999999999"), {":10: the number of elements is 999999999"});
  expectRefused(replaced(text, "9 4 7 1 4", "9 4 7 1 3"),
                {":13: element 9 has 3 nodes; its type 4 must have 4", "export the mesh again"});
  expectRefused(replaced(text, "9 4 7 1 4", "9 4 7 1 -4"), {":13: element 9 has -4 nodes"});
  expectRefused(replaced(text, "9 4 7 1 4", "9 11 7 1 4"), {":13: element 9 has 4 nodes; its type 11 must have 10"});
  expectRefused(replaced(text, "3 41 5\n$ENDELM", "3 41 6\n$ENDELM"),
                {":14: element 8 refers to node tag 6, which $NOD does not define"});
}

TEST(GmshMesh, NamesCountsThatDoNotFit) {
  expectRefused(replaced(kText22, "$Nodes\n5", "$Nodes\n4"),
                {":13: expected $EndNodes, found '5'", "more than its count"});
  expectRefused(replaced(kText22, "$Nodes\n5", "$Nodes\n6"), {":14: expected a node tag", "'$EndNodes'", "shorter"});
  expectRefused(replaced(kText22, "$Nodes\n5", "$Nodes\n-1"), {":8: the number of nodes is -1"});
  expectRefused(replaced(kText22, "$Nodes\n5", "$Nodes\n4000000000"),
                {":8: the number of nodes is 4000000000", "truncated"});
  expectRefused(replaced(kText22, "$Nodes\n5", "$Nodes\n99999999999999999999"),
                {":8: expected the number of nodes", "64 bits"});
  expectRefused(replaced(kText22, "$Elements\n4", "$Elements\n9223372036854775807"),
                {":16: the number of elements is"});
  expectRefused(replaced(kText22, "9 4 2", "9 4 -2"), {":19: the number of an element's tags is -2"});
  expectRefused(replaced(kText22, "9 4 2", "9 4 2000000000"), {":19: the number of an element's tags is 2000000000"});
  expectRefused(replaced(kText41, "1 1 1 2\n70", "1 1 1 6\n70"), {":6: a block has 6 nodes, but only 5 are left"});
  expectRefused(replaced(kText41, "2 5 3", "2 6 3"), {"1 nodes fewer than its total"});
  expectRefused(replaced(kText41, "2 3 1", "2 4 1"), {"1 elements fewer than its total"});
  expectRefused(replaced(kText41, "2 5 3", "2 1000 3"), {":5: the number of nodes is 1000"});
  expectRefused(replaced(kText41, "2 5 3", "99999 5 3"), {"the number of entity blocks is 99999"});
  expectRefused(replaced(kText41, "1 1 1 2\n70", "4 1 1 2\n70"), {":6: entity dimension 4"});
}

TEST(GmshMesh, BinaryCountsAreCheckedBeforeAnythingIsAllocated) {
  const TetMesh mesh = twoTetrahedra();
  for (const std::int64_t count : {std::int64_t{-1}, std::int64_t{6}, std::int64_t{1} << 40, INT64_MAX, INT64_MIN}) {
    std::string bytes = msh4Binary(mesh, false, true);
    const std::size_t at = bytes.find("$Nodes\n") + 7 + 8;
    bytes.replace(at, 8, ByteWriter(false).integer(count, 8).bytes());
    expectRefused(bytes, {"byte ", "nodes"});
  }
  std::string bytes = msh22Binary(mesh, false);
  const std::size_t blocks =
      bytes.find("$Elements\n3\n") + 12 + 28;  // behind the header and the only element of the first block
  bytes.replace(blocks + 4, 4, ByteWriter(false).integer(0, 4).bytes());
  expectRefused(bytes, {"byte " + std::to_string(blocks + 4), "a block has 0 elements"});
}

TEST(GmshMesh, NamesNumbersThatAreWrong) {
  expectRefused(replaced(kText22, "3 0 1 0", "3 0 one 0"), {":11: expected a node's y", "'one'"});
  expectRefused(replaced(kText22, "3 0 1 0", "3 0 1.0.0 0"), {":11: expected a node's y", "'1.0.0'"});
  expectRefused(replaced(kText22, "3 0 1 0", "3 0 1e999 0"), {":11: expected a node's y", "'1e999'"});
  expectRefused(replaced(kText22, "3 0 1 0", "3.5 0 1 0"), {":11: expected a node tag", "'3.5'"});
  for (const char* bad : {"nan", "inf", "-inf", "NAN"}) {
    expectRefused(replaced(kText22, "41 0 0 1", "41 0 0 " + std::string(bad)), {":12: node 3 ", "finite"});
  }
  std::string bytes = msh4Binary(twoTetrahedra(), true, false);
  const std::string one = ByteWriter(true).real(1.0).bytes();
  const std::string nan = ByteWriter(true).real(std::nan("")).bytes();
  bytes.replace(bytes.find(one), one.size(), nan);  // the first of some
  expectRefused(bytes, {"byte ", "node 1 ", "nan"});
}

TEST(GmshMesh, NamesTagsThatAreWrong) {
  expectRefused(replaced(kText22, "2000000000 3 41 5", "2000000000 3 41 6"), {":20: element 8 refers to node tag 6"});
  expectRefused(replaced(kText22, "41 0 0 1", "-41 0 0 1"), {":12: node tag -41 is negative"});
  expectRefused(replaced(kText22, "41 0 0 1", "3 0 0 1"), {"nodes 2 and 3 ", "both have the tag 3"});
  expectRefused(replaced(kText41, "9 70 9000000000000000001", "9 70 9000000000000000000"),
                {":24: element 9 refers to node tag 9000000000000000000"});
}

TEST(GmshMesh, NamesElementTypesItCannotSkip) {
  expectRefused(replaced(kText22, "2 2 2 0 1", "2 35 2 0 1"), {":18: element 2 has the type 35"});
  expectRefused(replaced(kText22, "2 2 2 0 1", "2 0 2 0 1"), {":18: element 2 has the type 0"});
  expectRefused(replaced(kText22, "2 2 2 0 1", "2 -7 2 0 1"), {":18: element 2 has the type -7"});
}

TEST(GmshMesh, ReadsEveryOtherElementByItsNumberOfNodes) {
  // Type and number of nodes, from the table of the Gmsh reference manual.
  const std::pair<int, int> types[] = {{1, 2},   {2, 3},   {3, 4},   {5, 8},   {6, 6},   {7, 5},   {8, 3},
                                       {9, 6},   {10, 9},  {12, 27}, {13, 18}, {14, 14}, {15, 1},  {16, 8},
                                       {17, 20}, {18, 15}, {19, 13}, {20, 9},  {21, 10}, {22, 12}, {23, 15},
                                       {24, 15}, {25, 21}, {26, 4},  {27, 5},  {28, 6}};
  for (const auto& [type, nodes] : types) {
    std::string element = "2 " + std::to_string(type) + " 2 0 1";
    for (int i = 0; i < nodes; ++i) element += " 70";
    SCOPED_TRACE(element);
    const std::string text = replaced(kText22, "2 2 2 0 1 70 2000000000 3", element);
    expectSameMesh(
        loadBytes(text),
        twoTetrahedra());  // of volumes that have collapsed to a point nothing is left: element_test has others
  }
}

}  // namespace gmsh_mesh_test
}  // namespace tissue_contact
