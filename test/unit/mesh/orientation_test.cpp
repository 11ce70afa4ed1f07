/// Tetrahedra numbered either way round: turned where that is all that is wrong with a mesh.
#include "mesh/orientation.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <utility>

#include "mesh_writers.h"

namespace tissue_contact {
namespace orientation_test {

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
  EXPECT_EQ(turnTetrahedra(mesh), reversed);
  EXPECT_NO_THROW(checkTetMesh(mesh, "block"));
  EXPECT_NEAR(volumeOf(mesh), 0.03 * 0.03 * 0.02, 1e-15);
  EXPECT_EQ(boundaryTriangles(mesh.tetrahedra).size(), boundaryTriangles(block().tetrahedra).size());
  EXPECT_EQ(turnTetrahedra(mesh), 0u);
}

/// A node that has been pulled through its neighbours turns the tetrahedra that it left behind: they lie on others then.
TEST(Orientation, AFoldedMeshStaysForTheCheckToRefuse) {
  TetMesh mesh = block();
  int inside = -1;
  for (int i = 0; i < mesh.positions.cols(); ++i) {
    const Vector3 at = mesh.positions.col(i);
    if (at.z() > 0.005 && at.z() < 0.015 && at.head<2>().cwiseAbs().maxCoeff() < 0.01) inside = i;
  }
  ASSERT_GE(inside, 0);
  mesh.positions.col(inside) += Vector3(0.018, 0.001, 0.002);
  const TetMesh before = mesh;
  EXPECT_EQ(turnTetrahedra(mesh), 0u);
  EXPECT_EQ(mesh.tetrahedra, before.tetrahedra);
  EXPECT_THROW(checkTetMesh(mesh, "block"), std::invalid_argument);
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
