/// @file
/// Tetrahedra that lie side by side and do not hang together: cracks, nodes in one place, parts.
#include "mesh/conformity.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <string>
#include <vector>

#include "mesh/coincident_nodes.h"
#include "mesh/labels.h"
#include "mesh/mesh_quality.h"
#include "mesh_writers.h"

namespace tissue_contact {
namespace conformity_test {

TetMesh block(BlockSplit split = BlockSplit::kFive) {
  return makeBlockMesh({Vector3(0.03, 0.03, 0.02), {3, 3, 2}, {}}, split);
}

TEST(Conformity, SoundMeshesAreAccepted) {
  for (const BlockSplit split : {BlockSplit::kFive, BlockSplit::kSix})
    EXPECT_NO_THROW(checkConforming(block(split), "mesh"));
  EXPECT_NO_THROW(checkConforming(twoTetrahedra(), "mesh"));
  TetMesh one = twoTetrahedra();
  one.tetrahedra.pop_back();
  EXPECT_NO_THROW(checkConforming(one, "mesh"));
}

/// Cells that are all split in the same five, so that the diagonals of faces between them cross: 16 % of the demo's force less, without a word.
TEST(Conformity, CrossedDiagonalsAreRefused) {
  for (const double warped_m : {0.0, 0.0004}) {
    TetMesh mesh = block();
    mesh.tetrahedra.clear();
    const int across = 4;
    for (int k = 0; k < 2; ++k) {
      for (int j = 0; j < 3; ++j) {
        for (int i = 0; i < 3; ++i) {
          const int n = i + across * (j + across * k);
          const int c[8] = {n, n + 1, n + across + 1, n + across, n + 16, n + 17, n + 16 + across + 1, n + 16 + across};
          for (const auto& t : {Tetrahedron{0, 1, 2, 5}, {0, 2, 7, 5}, {0, 2, 3, 7}, {0, 5, 7, 4}, {2, 7, 5, 6}}) {
            mesh.tetrahedra.push_back({c[t[0]], c[t[1]], c[t[2]], c[t[3]]});
          }
        }
      }
    }
    mesh.positions.col(21) += warped_m * Vector3(1.0, -1.0, 1.0);
    EXPECT_NO_THROW(checkTetMesh(mesh, "mesh"));
    expectRefusal([&] { checkConforming(mesh, "mesh"); },
                  {"mesh: the elements on both sides of the quadrangle of nodes ", "different diagonals",
                   "split neighbours mirrored"});
  }
}

/// A hole as large as one element is no crack.
TEST(Conformity, HolesAreNoCracks) {
  TetMesh mesh = makeBlockMesh({Vector3(0.03, 0.03, 0.03), {5, 5, 5}, {}});
  for (std::size_t i = 0; i < 5; ++i) {
    TetMesh holed = mesh;
    holed.tetrahedra.erase(holed.tetrahedra.begin() + 62 * 5 + static_cast<std::ptrdiff_t>(i));
    EXPECT_NO_THROW(checkConforming(holed, "mesh")) << i;
  }
}

/// Each element with nodes of its own, as deal.II and discontinuous fields of FEniCS are written.
TetMesh apart(const TetMesh& mesh) {
  TetMesh separate;
  separate.positions.resize(3, static_cast<Eigen::Index>(4 * mesh.tetrahedra.size()));
  for (const Tetrahedron& tet : mesh.tetrahedra) {
    const auto first = static_cast<int>(4 * separate.tetrahedra.size());
    for (int i = 0; i < 4; ++i)
      separate.positions.col(first + i) = mesh.positions.col(tet[static_cast<std::size_t>(i)]);
    separate.tetrahedra.push_back({first, first + 1, first + 2, first + 3});
  }
  return separate;
}

TEST(Conformity, CountsPartsThatShareNoNode) {
  EXPECT_EQ(countParts(block()), 1u);
  EXPECT_EQ(countParts(apart(block())), 90u);
  TetMesh with_loose_node = twoTetrahedra();
  with_loose_node.positions.conservativeResize(Eigen::NoChange, 6);
  with_loose_node.positions.col(5).setZero();
  EXPECT_EQ(countParts(with_loose_node), 1u);
}

TEST(Conformity, CountsPartsThatShareNoFace) {
  EXPECT_EQ(countPartsByFaces(block()), 1u);
  EXPECT_EQ(countPartsByFaces(apart(block())), 90u);
  EXPECT_EQ(countPartsByFaces(twoTetrahedra()), 1u);
  TetMesh hinged = twoTetrahedra();  // the second by an edge of the first alone
  hinged.positions.conservativeResize(Eigen::NoChange, 7);
  hinged.positions.col(5) = Vector3(5, 5, 5);
  hinged.positions.col(6) = Vector3(6, 5, 5);
  hinged.tetrahedra[1] = {hinged.tetrahedra[0][0], hinged.tetrahedra[0][1], 5, 6};
  EXPECT_EQ(countPartsByFaces(hinged), 2u);
  EXPECT_EQ(countParts(hinged), 1u);
}

class CoincidentNodesOfFiles : public testing::Test {
 protected:
  TetMesh load(CoincidentNodes treatment) {
    MeshDescription description = meshFile(file_.path());
    description.coincident_nodes = treatment;
    MeshPreparation preparation;
    preparation.say = [&](const std::string& line) { said_ += line + "\n"; };
    return loadTetMesh(description, preparation);
  }
  FileOfBytes file_{VtkWriter({"3.0", false, 8, 8, false}).write(apart(block()))};
  std::string said_;
};

TEST_F(CoincidentNodesOfFiles, AreRefusedUnlessTheSceneSaysWhatTheyAre) {
  expectRefusal([&] { load(CoincidentNodes::kRefuse); },
                {"nodes 2 and 5 (0-based, in file order) both lie at (", "and 311 more in the place of others",
                 "do not hang together", "`coincident_nodes: merge`", "`keep`"});
}

TEST_F(CoincidentNodesOfFiles, AreMerged) {
  const TetMesh mesh = load(CoincidentNodes::kMerge);
  EXPECT_EQ(mesh.positions.cols(), block().positions.cols());
  EXPECT_NO_THROW(checkTetMesh(mesh, "mesh"));
  EXPECT_EQ(countParts(mesh), 1u);
  EXPECT_EQ(boundaryTriangles(mesh.tetrahedra).size(), boundaryTriangles(block().tetrahedra).size());
  EXPECT_NEAR(totalVolume(mesh), totalVolume(block()), 1e-15);
  EXPECT_NE(said_.find("312 nodes that lay where others do are merged with them"), std::string::npos) << said_;
}

TEST_F(CoincidentNodesOfFiles, AreKeptAsACut) {
  const TetMesh mesh = load(CoincidentNodes::kKeep);
  EXPECT_EQ(mesh.positions.cols(), 360);
  EXPECT_NE(said_.find("90 parts that share no node"), std::string::npos) << said_;
}

/// A scanner's frame, and every other element written in single precision: neighbours differ by a unit in the last place of 900 mm.
TEST(CoincidentNodes, AreAsNearAsSinglePrecisionFarFromTheOrigin) {
  TetMesh mesh = apart(block());
  const double size = (mesh.positions.rowwise().maxCoeff() - mesh.positions.rowwise().minCoeff()).maxCoeff();
  mesh.positions *= 60.0 / size;
  mesh.positions.row(2).array() -= 900.0;
  for (Eigen::Index i = 0; i < mesh.positions.cols(); ++i) {
    if (i % 8 < 4) mesh.positions.col(i) = mesh.positions.col(i).cast<float>().cast<double>();
  }
  const FileOfBytes file(VtkWriter({"3.0", false, 8, 8, false}).write(mesh));
  MeshDescription description = meshFile(file.path());
  description.coincident_nodes = CoincidentNodes::kMerge;
  const TetMesh merged = loadTetMesh(description);
  EXPECT_EQ(countParts(merged), 1u);
  EXPECT_EQ(merged.positions.cols(), block().positions.cols());

  mesh.positions.row(2).array() +=
      1e9;  // where that resolution is larger than the elements, no corners of one are joined
  const FileOfBytes far(VtkWriter({"3.0", false, 8, 8, false}).write(mesh));
  description.file = far.path();
  EXPECT_NO_THROW(checkTetMesh(loadTetMesh(description), "mesh"));
}

TEST(CoincidentNodes, ThoseThatHardlyMissEachOtherAreTold) {
  const auto saidOf = [](double gap, CoincidentNodes treatment) {
    TetMesh mesh = apart(twoTetrahedra());
    for (Eigen::Index i = 4; i < 8; ++i) mesh.positions.col(i) += Vector3(gap, 0.0, 0.0);
    const FileOfBytes file(VtkWriter({"3.0", false, 8, 8, false}).write(mesh));
    MeshDescription description = meshFile(file.path());
    description.coincident_nodes = treatment;
    std::string said;
    MeshPreparation preparation;
    preparation.say = [&](const std::string& line) { said += line + "\n"; };
    loadTetMesh(description, preparation);
    return said;
  };
  const std::string said = saidOf(1e-4, CoincidentNodes::kMerge);
  EXPECT_NE(said.find("3 nodes lie nearer to others"), std::string::npos) << said;
  EXPECT_NE(said.find("cut open"), std::string::npos) << said;
  EXPECT_EQ(saidOf(1e-4, CoincidentNodes::kKeep).find("cut open"), std::string::npos);  // which the scene says
  EXPECT_EQ(saidOf(0.1, CoincidentNodes::kMerge).find("cut open"), std::string::npos);
  EXPECT_EQ(saidOf(0.0, CoincidentNodes::kMerge).find("cut open"), std::string::npos);
}

TEST(FlatElements, AreToldWithThePlaceOfTheFlattest) {
  TetMesh mesh = twoTetrahedra();
  EXPECT_EQ(flatElementsText(mesh), "");
  EXPECT_EQ(flatElementsText(block()), "");
  // A third on three nodes of the first, its own a hair outside their middle: dihedral angles of some 1e-3.
  const Tetrahedron& first = mesh.tetrahedra[0];
  mesh.positions.conservativeResize(Eigen::NoChange, 6);
  const Vector3 a = mesh.positions.col(first[0]), b = mesh.positions.col(first[1]), c = mesh.positions.col(first[2]);
  const Vector3 middle = (a + b + c) / 3.0;
  mesh.positions.col(5) = middle - 3e-4 * (b - a).cross(c - a).normalized();
  mesh.tetrahedra.push_back({first[0], first[1], first[2], 5});
  const std::string text = flatElementsText(mesh);
  EXPECT_NE(text.find("warning: 1 of 3 elements are flat"), std::string::npos) << text;
  EXPECT_NE(text.find("the flattest at 0.0"), std::string::npos) << text;

  const FileOfBytes file(VtkWriter({"3.0", false, 8, 8, false}).write(mesh));
  std::string said;
  MeshPreparation preparation;
  preparation.say = [&](const std::string& line) { said += line + "\n"; };
  loadTetMesh(meshFile(file.path()), preparation);
  EXPECT_NE(said.find("1 of 3 elements are flat"), std::string::npos) << said;
}

/// A node that nothing uses, however far: cells of the grid are counted from those of elements.
TEST(NearNodes, AreFoundInReasonableTimeBesideNodesThatAreFar) {
  TetMesh mesh = makeBlockMesh({Vector3(0.03, 0.03, 0.02), {30, 30, 20}, {}}, BlockSplit::kFive);
  EXPECT_EQ(findNearNodes(mesh).count, 0u);
  mesh.positions.conservativeResize(Eigen::NoChange, mesh.positions.cols() + 1);
  mesh.positions.rightCols<1>() = Vector3(-1e300, 0, 0);
  EXPECT_EQ(findNearNodes(mesh).count, 0u);
  mesh.positions.rightCols<1>() = mesh.positions.col(0) + Vector3(1e-9, 0, 0);
  EXPECT_EQ(findNearNodes(mesh).count, 0u);
}

/// Groups name the nodes that are left. Nodes that no volume uses are not looked at, wherever they lie.
TEST(CoincidentNodes, GroupsFollowAndLooseNodesDoNotCount) {
  const std::string text =
      "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n1\n0 3 \"pin\"\n$EndPhysicalNames\n$Nodes\n10\n"
      "1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n5 1 0 0\n6 0 1 0\n7 0 0 1\n8 1 1 1\n9 1e9 0 0\n10 1e9 0 0\n$EndNodes\n"
      "$Elements\n3\n1 15 2 3 1 7\n2 4 2 0 1 1 2 3 4\n3 4 2 0 1 5 6 7 8\n$EndElements\n";
  const FileOfBytes file(text);
  MeshDescription description = meshFile(file.path(), true);
  description.coincident_nodes = CoincidentNodes::kMerge;
  MeshLabels labels;
  const TetMesh mesh = loadTetMesh(description, {}, &labels);
  expectSameMesh(mesh, twoTetrahedra());
  EXPECT_EQ(labels.groups.at(0).elements, (std::vector<std::array<int, 4>>{{3, -1, -1, -1}}));
}

}  // namespace conformity_test
}  // namespace tissue_contact
