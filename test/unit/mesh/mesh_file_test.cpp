/// @file
/// loadTetMesh whatever the format: paths, scale, unreferenced nodes, meshes without tetrahedra, and real organs.
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <cmath>
#include <filesystem>
#include <limits>
#include <string>

#include "mesh_writers.h"

namespace tissue_contact {
namespace mesh_file_test {

/// One tetrahedron on nodes 1, 2, 4 and 5 of six: 0 and 3 belong to none.
const char* const kUnreferenced =
    "# vtk DataFile Version 3.0\nt\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 6 double\n"
    "9 9 9 0 0 0 1 0 0 8 8 8 0 1 0 0 0 1\nCELLS 2 7\n4 1 2 4 5\n1 3\nCELL_TYPES 2\n10 1\n";

void expectPathRefused(const std::string& path, const char* words) {
  expectRefusal([&] { loadTetMesh(meshFile(path)); }, {path, words});
}

TEST(MeshFile, RefusesPathsThatAreNoFile) {
  expectPathRefused("/no/such/mesh.vtk", "does not exist");
  expectPathRefused(testing::TempDir(), "not a regular file");
  expectPathRefused("/dev/zero", "not a regular file");
  expectPathRefused("", "does not exist");
}

TEST(MeshFile, PointersOfLfsAndAnnexAreCalledThat) {
  expectRefused("version https://git-lfs.github.com/spec/v1\noid sha256:4d7a214614ab\nsize 12345\n",
                {"git-lfs", "git lfs pull"});
  expectRefused("/annex/objects/SHA256E-s9--4d7a.vtk\n", {"git-annex", "git annex get"});
}

TEST(MeshFile, DoesNotWaitForAPipe) {
  const TemporaryDirectory directory;
  const std::string pipe = directory.path("pipe");
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  expectPathRefused(pipe, "not a regular file");
}

TEST(MeshFile, RefusesAFileTooLargeWithoutReadingIt) {
  const FileOfBytes file("$MeshFormat\n");
  std::filesystem::resize_file(file.path(), std::uintmax_t{1} << 40U);  // sparse: takes no room
  expectPathRefused(file.path(), "at most 268435456");
}

TEST(MeshFile, RefusesWhatIsNoMesh) {
  expectRefused("", {"empty"});
  expectRefused(" \n\n", {"empty"});
  expectRefused("solid liver\nfacet normal\n", {":1: ", "'solid liver'", "neither Gmsh", "legacy VTK"});
  expectRefused("<?xml version=\"1.0\"?>\n<VTKFile type=\"UnstructuredGrid\">",
                {"XML is not read", "meshio convert FILE organ.vtk"});
  expectRefused("<?xml version=\"1.0\"?>\n<VTKFile type=\"PolyData\">",
                {"XML is not read", "save this surface as .stl"});
  expectRefused(std::string("\0\xff\x7f garbage", 11), {"'???"});
  expectRefused("$", {"expected $MeshFormat"});
}

TEST(MeshFile, RefusesAMeshWithoutTetrahedra) {
  expectRefused(replaced(kUnreferenced, "10 1", "9 1"), {"no tetrahedra", "6 nodes", "2 elements of other kinds"});
  expectRefused("$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n0\n$EndNodes\n$Elements\n0\n$EndElements\n",
                {"no tetrahedra", "0 nodes"});
  expectRefused(
      "# vtk DataFile Version 5.1\nt\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 0 float\nCELLS 0 0\n"
      "OFFSETS vtktypeint64\nCONNECTIVITY vtktypeint64\nCELL_TYPES 0\n",
      {"no tetrahedra"});
}

TEST(MeshFile, ScalesCoordinates) {
  MeshDescription description = meshFile(fixturePath("box_v2_binary.vtk"));
  const TetMesh metres = loadTetMesh(description);
  description.scale_m_per_unit = 0.001;
  const TetMesh millimetres = loadTetMesh(description);
  EXPECT_TRUE(millimetres.positions.isApprox(0.001 * metres.positions, 1e-15));
  EXPECT_NEAR(totalVolume(millimetres), 2e-9, 1e-20);
}

TEST(MeshFile, RefusesABadScale) {
  MeshDescription description = meshFile(fixturePath("box_v2_binary.vtk"));
  for (const double bad : {0.0, -0.001, std::nan(""), std::numeric_limits<double>::infinity()}) {
    description.scale_m_per_unit = bad;
    EXPECT_THROW(loadTetMesh(description), std::invalid_argument) << bad;
  }
  description.scale_m_per_unit = 1.7e308;  // 2 * 1.7e308 overflows
  EXPECT_THROW(loadTetMesh(description), std::invalid_argument);
}

TEST(MeshFile, RemovesUnreferencedNodesOnRequestOnly) {
  const FileOfBytes file(kUnreferenced);
  const TetMesh all = loadTetMesh(meshFile(file.path()));
  EXPECT_EQ(all.positions.cols(), 6);
  EXPECT_EQ(all.tetrahedra, (std::vector<Tetrahedron>{{1, 2, 4, 5}}));
  EXPECT_THROW(checkTetMesh(all, "mesh"), std::invalid_argument);
  const TetMesh used = loadTetMesh(meshFile(file.path(), true));
  EXPECT_TRUE(used.positions.leftCols(3) == (NodalVectors(3, 3) << 0, 1, 0, 0, 0, 1, 0, 0, 0).finished());
  EXPECT_EQ(used.positions.cols(), 4);
  EXPECT_EQ(used.tetrahedra, (std::vector<Tetrahedron>{{0, 1, 2, 3}}));
  EXPECT_NO_THROW(checkTetMesh(used, "mesh"));
}

/// The second lies on the first.
TEST(MeshFile, AFoldIsRefused) {
  expectRefused(
      "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n5\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n5 .1 .1 .1\n$EndNodes\n"
      "$Elements\n2\n1 4 0 1 2 3 4\n2 4 0 2 3 4 5\n$EndElements\n",
      {"tetrahedra 0 and 1 lie on the same side of the face they share (nodes 1, 2, 3)",
       "one of them is inverted (as they are numbered, tetrahedron 1)"});
}

/// Real meshes. The volumes were computed from the files' bytes by a separate Python script in exact rational
/// arithmetic (sum of the elements' determinants), then rounded once; the bounds are the extreme coordinates of the
/// used nodes.
struct Organ {
  const char* file;
  double scale;
  Eigen::Index nodes;
  std::size_t tetrahedra;
  double volume_units;  ///< file units cubed
  Vector3 min;          ///< file units
  Vector3 max;
};

const Organ kOrgans[] = {
    {"liver_volumetric.vtk", 0.001, 98, 273, 1179442.2831651319,
     Vector3(-70.859771728515625, -76.038864135742188, -73.729011535644531),
     Vector3(70.166297912597656, 95.707542419433594, 85.809761047363281)},
    {"gallbladder_volumetric.vtk", 0.001, 366, 1063, 34122.545206922296,
     Vector3(-83.505142211914062, -22.385335922241211, -47.514759063720703),
     Vector3(-3.6772353649139404, 29.292184829711914, 0.65934228897094727)},
    {"tissue_volume.msh", 1.0, 493, 1432, 0.00011520248296851886,
     Vector3(-0.060045678168535233, 0.0049998126924037933, -0.060018736869096763),
     Vector3(0.060045544058084488, 0.0130000077188015, 0.060018636286258698)},
};

TEST(MeshFile, RealOrgansHaveTheirSizeAndVolume) {
  const std::string directory = std::string(TISSUE_CONTACT_SHARED_DATA) + "/organs/";
  if (!std::filesystem::is_directory(directory)) GTEST_SKIP() << "no organ meshes at " << directory;
  for (const Organ& organ : kOrgans) {
    SCOPED_TRACE(organ.file);
    MeshDescription description = meshFile(directory + organ.file, true);
    description.scale_m_per_unit = organ.scale;
    const TetMesh mesh = loadTetMesh(description);
    EXPECT_EQ(mesh.positions.cols(), organ.nodes);
    EXPECT_EQ(mesh.tetrahedra.size(), organ.tetrahedra);
    EXPECT_NO_THROW(checkTetMesh(mesh, organ.file));
    const double volume = organ.volume_units * std::pow(organ.scale, 3);
    EXPECT_NEAR(totalVolume(mesh), volume, 1e-13 * volume);
    EXPECT_TRUE(mesh.positions.rowwise().minCoeff().isApprox(organ.scale * organ.min, 1e-15));
    EXPECT_TRUE(mesh.positions.rowwise().maxCoeff().isApprox(organ.scale * organ.max, 1e-15));
  }
}

TEST(MeshFile, TheGallbladdersLooseNodeIsNamedWithTheFix) {
  const std::string file = std::string(TISSUE_CONTACT_SHARED_DATA) + "/organs/gallbladder_volumetric.vtk";
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "no organ mesh " << file;
  const TetMesh mesh = loadTetMesh(meshFile(file));
  EXPECT_EQ(mesh.positions.cols(), 367);
  expectRefusal(
      [&] { checkTetMesh(mesh, "tissue 'gallbladder'"); },
      {"tissue 'gallbladder': node 314 belongs to no tetrahedron (1 such", "`remove_unreferenced_nodes: true`"});
}

}  // namespace mesh_file_test
}  // namespace tissue_contact
