/// Surfaces filled with tetrahedra by the program gmsh: what comes out, what is mended, what is refused and in which words.
#include "mesh/fill/fill_surface.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <sstream>
#include <stdexcept>
#include <string>

#include "mesh/fill/closed_surface.h"
#include "mesh/fill/crossing_triangles.h"
#include "mesh/fill/run_program.h"
#include "mesh/mesh_quality.h"
#include "support/refusal.h"
#include "support/temporary_directory.h"
#include "tissue_contact/mesh/gmsh_version.h"
#include "tissue_contact/mesh/triangle_mesh.h"

namespace tissue_contact {
namespace fill_surface_test {

constexpr double kPi = 3.14159265358979323846;

/// Ball of meridians and parallels, outward, in millimetres.
TriangleMesh ball(double radius, const Vector3& centre = Vector3::Zero(), int rings = 20) {
  const int around = 2 * rings;
  TriangleMesh mesh;
  mesh.vertices.resize(3, 2 + (rings - 1) * around);
  mesh.vertices.col(0) = centre + radius * Vector3::UnitZ();
  mesh.vertices.col(1) = centre - radius * Vector3::UnitZ();
  const auto at = [&](int ring, int i) { return 2 + (ring - 1) * around + i % around; };
  for (int ring = 1; ring < rings; ++ring) {
    for (int i = 0; i < around; ++i) {
      const double a = kPi * ring / rings;
      const double b = kPi * i / rings;
      mesh.vertices.col(at(ring, i)) =
          centre + radius * Vector3(std::sin(a) * std::cos(b), std::sin(a) * std::sin(b), std::cos(a));
    }
  }
  for (int i = 0; i < around; ++i) {
    mesh.triangles.push_back({0, at(1, i), at(1, i + 1)});
    for (int ring = 1; ring + 1 < rings; ++ring) {
      mesh.triangles.push_back({at(ring, i), at(ring + 1, i), at(ring, i + 1)});
      mesh.triangles.push_back({at(ring, i + 1), at(ring + 1, i), at(ring + 1, i + 1)});
    }
    mesh.triangles.push_back({at(rings - 1, i), 1, at(rings - 1, i + 1)});
  }
  return mesh;
}

TriangleMesh together(TriangleMesh a, const TriangleMesh& b) {
  const auto first = static_cast<int>(a.vertices.cols());
  a.vertices.conservativeResize(Eigen::NoChange, first + b.vertices.cols());
  a.vertices.rightCols(b.vertices.cols()) = b.vertices;
  for (const Triangle& t : b.triangles) a.triangles.push_back({t[0] + first, t[1] + first, t[2] + first});
  return a;
}

TriangleMesh insideOut(TriangleMesh mesh) {
  for (Triangle& t : mesh.triangles) std::swap(t[1], t[2]);
  return mesh;
}

std::string objText(const TriangleMesh& mesh) {
  std::ostringstream text;
  text.precision(17);
  for (Eigen::Index i = 0; i < mesh.vertices.cols(); ++i) text << "v " << mesh.vertices.col(i).transpose() << "\n";
  for (const Triangle& t : mesh.triangles) text << "f " << t[0] + 1 << " " << t[1] + 1 << " " << t[2] + 1 << "\n";
  return text.str();
}

std::string plyText(const TriangleMesh& mesh) {
  std::ostringstream text;
  text.precision(17);
  text << "ply\nformat ascii 1.0\nelement vertex " << mesh.vertices.cols()
       << "\nproperty double x\nproperty double y\nproperty double z\nelement face " << mesh.triangles.size()
       << "\nproperty list uchar int vertex_indices\nend_header\n";
  for (Eigen::Index i = 0; i < mesh.vertices.cols(); ++i) text << mesh.vertices.col(i).transpose() << "\n";
  for (const Triangle& t : mesh.triangles) text << "3 " << t[0] << " " << t[1] << " " << t[2] << "\n";
  return text.str();
}

std::string stlText(const TriangleMesh& mesh) {
  std::ostringstream text;
  text.precision(9);
  text << "solid test\n";
  for (const Triangle& t : mesh.triangles) {
    text << "facet normal 0 0 0\nouter loop\n";
    for (const int v : t) text << "vertex " << mesh.vertices.col(v).transpose() << "\n";
    text << "endloop\nendfacet\n";
  }
  text << "endsolid test\n";
  return text.str();
}

class FillSurface : public testing::Test {
 protected:
  void SetUp() override {
    try {
      gmshVersion();
    } catch (
        const std::invalid_argument& error) {  // none, or one that is too old: what is refused, WhicheverGmsh tests
      GTEST_SKIP() << error.what();
    }
  }

  MeshDescription described(const std::string& name, const std::string& content) {
    MeshDescription description;
    description.file = directory_.write(name, content);
    description.scale_m_per_unit = 0.001;
    description.cell_size_m = 0.005;
    return description;
  }

  /// @param cached whether results are kept.
  TetMesh fill(const MeshDescription& description, bool cached = false) {
    said_.clear();
    MeshPreparation preparation;
    preparation.say = [this](const std::string& line) { said_ += line + "\n"; };
    if (cached) preparation.cache_directory = directory_.path("cache");
    return fillSurface(description, preparation);
  }
  TetMesh fill(const TriangleMesh& surface) { return fill(described("surface.obj", objText(surface))); }
  std::string refusalOf(const TriangleMesh& surface) {
    return refusal([&] { fill(surface); });
  }

  /// The only file in the cache.
  std::filesystem::path keptFile() const {
    return std::filesystem::directory_iterator(directory_.path("cache/meshes"))->path();
  }

  TemporaryDirectory directory_;
  std::string said_;
};

/// Where programs are looked for, while it lives.
class PathOfPrograms {
 public:
  explicit PathOfPrograms(const std::string& path) : before_(now()) { setenv("PATH", path.c_str(), 1); }
  ~PathOfPrograms() { setenv("PATH", before_.c_str(), 1); }
  PathOfPrograms(const PathOfPrograms&) = delete;
  PathOfPrograms& operator=(const PathOfPrograms&) = delete;

  static std::string now() {
    const char* path = std::getenv("PATH");
    return path == nullptr ? "" : path;
  }

 private:
  const std::string before_;
};

double volumeOf(const TetMesh& mesh) { return qualityOf(mesh).volume; }
const double kBall = 4.0 / 3.0 * kPi * std::pow(0.02, 3);  // of 20 mm radius, m^3

TEST_F(FillSurface, ABallOfEveryFormat) {
  const TriangleMesh surface = ball(20.0);
  const std::pair<const char*, std::string> files[] = {
      {"a.obj", objText(surface)}, {"a.ply", plyText(surface)}, {"a.stl", stlText(surface)}};
  for (const auto& [name, content] : files) {
    const TetMesh mesh = fill(described(name, content));
    SCOPED_TRACE(name);
    checkTetMesh(mesh, name);
    EXPECT_NEAR(volumeOf(mesh), kBall, 0.05 * kBall) << "chords of 5 mm take some 2 %";
    EXPECT_GT(qualityOf(mesh).smallest_angle, 5.0);
    EXPECT_GT(mesh.tetrahedra.size(), 500u);
    EXPECT_LT(mesh.tetrahedra.size(), 5000u) << "cells of 5 mm, not of the surface's 3 mm";
    expectContains(said_, {name, "tetrahedra", "smallest angle", "% of the surface's", "gmsh"});
  }
}

// Gmsh meshes a surface anew with triangles of a cell: hardly any volume is in a needle of 6 mm by 40.
TEST_F(FillSurface, PartsThinnerThanCellsAreTold) {
  TriangleMesh surface = ball(20.0);
  fill(surface);
  EXPECT_EQ(said_.find("farther than a cell"), std::string::npos) << said_;
  surface.vertices(2, 0) = 60.0;  // the pole
  const TetMesh mesh = fill(surface);
  const double left_out_mm = 60.0 - 1e3 * mesh.positions.row(2).maxCoeff();
  ASSERT_GT(left_out_mm, 5.0) << "this gmsh keeps it";
  expectContains(said_, {"% of the surface's vertices are farther than a cell from that mesh, most ",
                         " mm, at (0, 0, 0.06) m: ", "smaller cell_size_m"});
}

// Of its four triangles alone gmsh 4.8 makes nothing, for as long as it may.
TEST_F(FillSurface, ATetrahedron) {
  TriangleMesh mesh;
  mesh.vertices.resize(3, 4);
  mesh.vertices << 0, 40, 0, 0, 0, 0, 40, 0, 0, 0, 0, 40;
  mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  const TetMesh filled = fill(mesh);
  EXPECT_GT(filled.tetrahedra.size(), 50U);
  EXPECT_NEAR(volumeOf(filled), 0.04 * 0.04 * 0.04 / 6.0, 1e-12);
}

TEST_F(FillSurface, TheSameBitsEveryTime) {
  const TetMesh first = fill(ball(20.0));
  const TetMesh second = fill(ball(20.0));
  EXPECT_EQ(first.tetrahedra, second.tetrahedra);
  EXPECT_TRUE(first.positions == second.positions);
}

TEST_F(FillSurface, IsKeptAndSaysTheSameAgain) {
  const MeshDescription description = described("a.obj", objText(together(ball(20.0), ball(1.0, {0, 0, 30}))));
  const TetMesh made = fill(description, true);
  expectContains(said_, {"dropped 1 loose part", "is kept as " + keptFile().string()});
  const TetMesh kept = fill(description, true);
  expectContains(said_, {"dropped 1 loose part", "was kept as " + keptFile().string()});
  EXPECT_EQ(made.tetrahedra, kept.tetrahedra);
  EXPECT_TRUE(made.positions == kept.positions);
  MeshDescription as_it_is;  // a mesh in metres that may be named in a scene
  as_it_is.file = keptFile().string();
  EXPECT_TRUE(loadTetMesh(as_it_is).positions == made.positions);
}

TEST_F(FillSurface, ADamagedKeptFileIsMadeAgain) {
  const MeshDescription description = described("a.obj", objText(ball(20.0)));
  const TetMesh made = fill(description, true);
  const std::string name = "cache/meshes/" + keptFile().filename().string();
  const std::string whole = directory_.read(name);
  std::string changed = whole;
  changed[whole.size() / 2] = changed[whole.size() / 2] == '1' ? '2' : '1';
  for (const std::string& damaged : {changed, whole.substr(0, whole.size() / 2), std::string("x")}) {
    directory_.write(name, damaged);
    EXPECT_TRUE(fill(description, true).positions == made.positions);
    expectContains(said_, {"is kept as"});
    EXPECT_EQ(directory_.read(name), whole);
  }
}

TEST_F(FillSurface, OtherCellsAreAnotherMesh) {
  MeshDescription description = described("a.obj", objText(ball(20.0)));
  const std::size_t coarse = fill(description, true).tetrahedra.size();
  description.cell_size_m = 0.003;
  const std::size_t fine = fill(description, true).tetrahedra.size();
  description.cell_size_inside_m = 0.009;
  const std::size_t graded = fill(description, true).tetrahedra.size();
  EXPECT_GT(fine, 2 * coarse);
  EXPECT_LT(graded, fine);
}

TEST_F(FillSurface, InsideOutIsTurned) {
  EXPECT_GT(volumeOf(fill(insideOut(ball(20.0)))), 0.0);
  expectContains(said_, {"inside out", "turned round"});
}

TEST_F(FillSurface, SmallHolesAreClosed) {
  TriangleMesh surface = ball(20.0);
  surface.triangles.erase(surface.triangles.begin() + 100, surface.triangles.begin() + 104);
  EXPECT_NEAR(volumeOf(fill(surface)), kBall, 0.05 * kBall);
  expectContains(said_, {"closed 1 hole"});
  EXPECT_EQ(said_.find("wrong way"), std::string::npos);
}

TEST_F(FillSurface, LargeHolesAreRefusedWithTheirPlace) {
  TriangleMesh surface = ball(20.0);
  const auto is_upper = [&](const Triangle& t) { return surface.vertices(2, t[0]) > 5.0; };
  surface.triangles.erase(std::remove_if(surface.triangles.begin(), surface.triangles.end(), is_upper),
                          surface.triangles.end());
  expectContains(refusalOf(surface), {"surface.obj", "is open: 1 hole", "mm across at (", "three cells", "shell"});
}

TEST_F(FillSurface, WhatPassesThroughItselfIsRefusedWithAPlace) {
  expectContains(refusalOf(together(ball(20.0), ball(20.0, {15, 3, 2}))),
                 {"surface.obj", "passes through itself", "pairs of triangles cross", ") m"});
}

// As a segmentation that has run through an organ's wall: the top is pushed in and comes out below.
TEST_F(FillSurface, OneClosedPartThatPassesThroughItselfIsRefusedWithAPlace) {
  TriangleMesh surface = ball(20.0);
  for (Eigen::Index i = 0; i < surface.vertices.cols(); ++i) {
    if (surface.vertices(2, i) > 17.0) surface.vertices(2, i) -= 50.0;
  }
  expectContains(
      refusal([&] { fill(described("crossed.stl", stlText(surface))); }),
      {"crossed.stl", "cannot be filled", "passes through itself", "pairs of triangles cross", "-0.0", ") m"});
}

// Their parts are told apart by one vertex: inside the first it makes the second look like a cavity.
TEST_F(FillSurface, CrossingPartsWithAVertexInsideAreRefusedWithAPlace) {
  for (const double radius : {20.0, 15.0}) {
    const TriangleMesh second = ball(radius, {15, 0, -5 - radius / 2});
    ASSERT_LT(second.vertices.col(0).norm(), 19.0);
    expectContains(refusalOf(together(ball(20.0), second)),
                   {"surface.obj", "passes through itself", "pairs of triangles cross", ") m"});
  }
}

TEST_F(FillSurface, SeveralBodiesAreRefused) {
  expectContains(refusalOf(together(ball(20.0), ball(20.0, {60, 0, 0}))), {"2 separate parts", "(0.06", "one body"});
}

TEST_F(FillSurface, ClosedPartsInsideStayHollow) {
  const TetMesh mesh = fill(together(ball(20.0), insideOut(ball(8.0))));
  const double hollow = kBall * (1.0 - std::pow(0.4, 3));
  EXPECT_NEAR(volumeOf(mesh), hollow, 0.05 * kBall);
  expectContains(said_, {"hollow"});
}

// Within two surfaces: it was taken for a cavity, which gmsh cannot fill, and smaller cells were said to help.
TEST_F(FillSurface, ABodyInACavityIsRefusedAsOne) {
  const std::string refusal = refusalOf(together(together(ball(20.0), ball(12.0)), ball(5.0)));
  expectContains(refusal, {"3 separate parts", "17 mm across, loose in the cavity of another", "one body"});
  fill(together(together(ball(20.0), ball(5.0, {10, 0, 0})), ball(5.0, {-10, 0, 0})));
  expectContains(said_, {"left 2 closed parts inside it hollow"});
}

TEST_F(FillSurface, WallsInsideAreRefused) {
  TriangleMesh surface = ball(20.0);
  surface.triangles.push_back({0, 1, surface.triangles[0][1]});
  surface.triangles.push_back({0, surface.triangles[0][1], surface.triangles[40][0]});
  expectContains(refusalOf(surface), {"more than two triangles", ") m"});
}

TEST_F(FillSurface, OtherUnitsAreSuspected) {
  MeshDescription description = described("a.obj", objText(ball(20.0)));
  description.scale_m_per_unit = 1.0;
  expectContains(refusal([&] { fill(description); }), {"40 x 40 x 40 m", "millimetres", "scale_m_per_unit: 0.001"});
  description.scale_m_per_unit = 1e-6;
  expectContains(refusal([&] { fill(description); }), {"fewer than three cells", "scale_m_per_unit"});
}

TEST_F(FillSurface, PointersAndRubbishAreRefused) {
  const std::string pointer = "version https://git-lfs.github.com/spec/v1\noid sha256:4d7a2146\nsize 1536384\n";
  expectContains(refusal([&] { fill(described("a.stl", pointer)); }), {"a.stl", "git lfs pull"});
  for (const char* name : {"b.stl", "b.obj", "b.ply"}) {
    expectContains(refusal([&] { fill(described(name, "no surface\n")); }), {name});
  }
}

TEST_F(FillSurface, LiverOfThousandsOfTriangles) {
  const std::string liver = std::string(TISSUE_CONTACT_SHARED_DATA) + "/organs/Liver.stl";
  if (!std::filesystem::exists(liver)) GTEST_SKIP() << "no file " << liver;
  MeshDescription description;
  description.file = liver;
  description.scale_m_per_unit = 0.001;
  description.cell_size_m = 0.012;
  const TetMesh mesh = fill(description);
  EXPECT_NEAR(volumeOf(mesh), 1.8177e-3, 0.03e-3) << "that of the surface, found with another program";
  EXPECT_GT(qualityOf(mesh).smallest_angle, 5.0);
}

class WhicheverGmsh : public FillSurface {
 protected:
  void SetUp() override {}
};

TEST_F(WhicheverGmsh, WithoutOneSaysHowToGetIt) {
  const PathOfPrograms path(directory_.path().string());
  const std::string message = refusalOf(ball(20.0));
  expectContains(message, {"gmsh", "not installed", "apt-get install gmsh"});
}

TEST_F(WhicheverGmsh, AnOldOneIsRefusedAndWhereToGetAnotherTold) {
  const auto refusal = [&](const std::string& version) {
    const std::string program = directory_.write("gmsh", "#!/bin/sh\necho " + version + "\n");
    std::filesystem::permissions(program, std::filesystem::perms::owner_all);
    const PathOfPrograms path(directory_.path().string() + ":/usr/bin:/bin");
    return refusalOf(ball(20.0));
  };
  expectContains(refusal("4.4.1"), {"gmsh 4.4.1 is too old", "4.7 or later", "pip3 install gmsh"});
  expectContains(refusal("3.0.6"), {"gmsh 3.0.6 is too old"});
  EXPECT_EQ(refusal("4.13.1").find("too old"), std::string::npos);
}

// A program that exports once more while gmsh runs: neither version may be kept as the other.
TEST_F(FillSurface, AFileThatIsWrittenToMeanwhileIsRefusedAndNotKept) {
  const MeshDescription description = described("organ.obj", objText(ball(20.0)));
  const std::string path = PathOfPrograms::now();
  const std::string program =
      directory_.write("gmsh", "#!/bin/sh\n[ \"$1\" = --version ] || echo 'v 9 9 9' >> '" + description.file +
                                   "'\nexport PATH='" + path + "'\nexec gmsh \"$@\"\n");
  std::filesystem::permissions(program, std::filesystem::perms::owner_all);
  {
    const PathOfPrograms with_ours(directory_.path().string() + ":" + path);
    expectContains(refusal([&] { fill(description, true); }), {"organ.obj", "written to while it was filled"});
  }
  EXPECT_FALSE(std::filesystem::exists(directory_.path("cache/meshes")));
  EXPECT_NO_THROW(fill(description, true));
}

TEST(CrossingTriangles, AreCountedWithAPlace) {
  EXPECT_EQ(findCrossings(ball(20.0)).count, 0u);
  const Crossings crossings = findCrossings(together(ball(20.0), ball(20.0, {30, 0, 0})));
  EXPECT_GT(crossings.count, 10u);
  EXPECT_NEAR(crossings.place.x(), 15.0, 1.0) << "on the plane between the two";
}

TEST(MeshQuality, OfARegularTetrahedron) {
  TetMesh mesh;
  mesh.positions.resize(3, 4);
  mesh.positions.transpose() << 0, 0, 0, 1, 1, 0, 1, 0, 1, 0, 1, 1;
  mesh.tetrahedra = {{0, 1, 3, 2}};
  if (signedVolume(mesh.positions, mesh.tetrahedra[0]) < 0.0) mesh.tetrahedra = {{0, 1, 2, 3}};
  EXPECT_NEAR(qualityOf(mesh).smallest_angle, 70.5288, 1e-3);
  EXPECT_NEAR(qualityOf(mesh).volume, 1.0 / 3.0, 1e-12);
}

}  // namespace fill_surface_test
}  // namespace tissue_contact
