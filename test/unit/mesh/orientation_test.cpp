/// @file
/// Tetrahedra numbered either way round: turned, and what is wrong beside that is refused in its own words.
#include "mesh/orientation.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <utility>

#include "mesh_writers.h"

namespace tissue_contact {
namespace orientation_test {

constexpr const char* kSource = "mesh file";

TetMesh block() { return makeBlockMesh({Vector3(0.03, 0.03, 0.02), {3, 3, 2}, {}}); }

double volumeOf(const TetMesh& mesh) {
  double volume = 0.0;
  for (const Tetrahedron& tet : mesh.tetrahedra) volume += signedVolume(mesh.positions, tet);
  return volume;
}

/// By some convention of another program: here by ascending nodes.
TEST(Orientation, ReversedTetrahedraAreTurned) {
  TetMesh mesh = block();
  for (Tetrahedron& tet : mesh.tetrahedra) std::sort(tet.begin(), tet.end());
  std::size_t reversed = 0;
  for (const Tetrahedron& tet : mesh.tetrahedra) reversed += signedVolume(mesh.positions, tet) < 0.0 ? 1 : 0;
  ASSERT_GT(reversed, 10u);
  ASSERT_LT(reversed, mesh.tetrahedra.size());
  EXPECT_EQ(turnTetrahedra(mesh, kSource), reversed);
  EXPECT_NO_THROW(checkTetMesh(mesh, "block"));
  EXPECT_NEAR(volumeOf(mesh), 0.03 * 0.03 * 0.02, 1e-15);
  EXPECT_EQ(boundaryTriangles(mesh.tetrahedra).size(), boundaryTriangles(block().tetrahedra).size());
  EXPECT_EQ(turnTetrahedra(mesh, kSource), 0u);
}

/// Numbered by ascending nodes, so that a third of the elements is reversed and means nothing.
TetMesh mixedBlock() {
  TetMesh mesh = block();
  for (Tetrahedron& tet : mesh.tetrahedra) std::sort(tet.begin(), tet.end());
  return mesh;
}

/// A node that has been pulled through its neighbours turns the tetrahedra that it left behind: they lie on others then.
TEST(Orientation, AFoldedMeshIsRefusedHoweverItIsNumbered) {
  for (TetMesh mesh : {block(), mixedBlock()}) {
    int inside = -1;
    for (int i = 0; i < mesh.positions.cols(); ++i) {
      const Vector3 at = mesh.positions.col(i);
      if (at.z() > 0.005 && at.z() < 0.015 && at.head<2>().cwiseAbs().maxCoeff() < 0.01) inside = i;
    }
    ASSERT_GE(inside, 0);
    mesh.positions.col(inside) += Vector3(0.018, 0.001, 0.002);
    expectRefusal([&] { turnTetrahedra(mesh, kSource); },
                  {"mesh file: tetrahedra ", "lie on the same side of the face they share", "folded there"});
  }
}

/// The second lies in the first; each numbered so that its own volume is positive, as programs do that orient what they save.
TEST(Orientation, AFoldOfPositiveTetrahedraIsRefused) {
  TetMesh mesh = twoTetrahedra();
  mesh.positions.col(4) = Vector3::Constant(0.1);
  mesh.tetrahedra[1] = {1, 2, 4, 3};
  ASSERT_GT(signedVolume(mesh.positions, mesh.tetrahedra[1]), 0.0);
  expectRefusal([&] { turnTetrahedra(mesh, kSource); }, {"tetrahedra 0 and 1 lie on the same side"});
}

/// Other faults of a mesh of mixed numbering are told as they are, not as a fold.
TEST(Orientation, OtherFaultsStayForTheChecks) {
  TetMesh twice = mixedBlock();
  twice.tetrahedra.push_back(twice.tetrahedra[7]);
  EXPECT_GT(turnTetrahedra(twice, kSource), 10u);
  expectRefusal([&] { checkTetMesh(twice, kSource); }, {"has the same four nodes as tetrahedron 7"});

  TetMesh flat = mixedBlock();
  const Tetrahedron sound = flat.tetrahedra[7];
  const auto middle = static_cast<int>(flat.positions.cols());
  flat.positions.conservativeResize(Eigen::NoChange, middle + 1);
  flat.positions.col(middle) = 0.5 * (flat.positions.col(sound[0]) + flat.positions.col(sound[1]));
  flat.tetrahedra.push_back({sound[0], sound[1], sound[2], middle});
  EXPECT_GT(turnTetrahedra(flat, kSource), 10u);
  expectRefusal([&] { checkTetMesh(flat, kSource); },
                {"tetrahedron " + std::to_string(flat.tetrahedra.size() - 1), "has no volume"});

  TetMesh three = mixedBlock();
  const Tetrahedron inner = three.tetrahedra[7];
  const auto above = static_cast<int>(three.positions.cols());
  three.positions.conservativeResize(Eigen::NoChange, above + 3);
  for (int i = 0; i < 3; ++i) three.positions.col(above + i) = Vector3(0.1 + 0.01 * i, 0.2, 0.3 - 0.02 * i);
  for (int i = 0; i < 3; ++i) three.tetrahedra.push_back({inner[0], inner[1], inner[2], above + i});
  EXPECT_GT(turnTetrahedra(three, kSource), 10u);
  expectRefusal([&] { boundaryTriangles(three.tetrahedra); }, {"belongs to ", "at most 2 may share it"});
}

/// As a file, with what is said of it.
TEST(Orientation, MeshFilesAreTurned) {
  const TetMesh right = twoTetrahedra();
  TetMesh mesh = right;
  std::swap(mesh.tetrahedra[1][0], mesh.tetrahedra[1][1]);
  const FileOfBytes file(msh22Binary(mesh, false));
  MeshPreparation preparation;
  std::string said;
  preparation.say = [&](const std::string& line) { said += line; };
  const TetMesh loaded = loadTetMesh(meshFile(file.path()), preparation);
  EXPECT_NEAR(volumeOf(loaded), volumeOf(right), 1e-15);
  EXPECT_NE(said.find("1 of 2 tetrahedra are numbered the other way round, and turned"), std::string::npos) << said;
}

}  // namespace orientation_test
}  // namespace tissue_contact
