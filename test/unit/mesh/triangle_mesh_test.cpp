#include "tissue_contact/mesh/triangle_mesh.h"

#include <gtest/gtest.h>
#include <sys/stat.h>

#include <algorithm>
#include <cctype>
#include <cstddef>
#include <limits>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "mesh_fixture.h"
#include "unit/instrument/instrument_fixture.h"

namespace tissue_contact {
namespace triangle_mesh_test {

const Vector3 kNoScale = Vector3::Ones();

class LoadTriangleMesh : public testing::Test {
 protected:
  TriangleMesh load(const std::string& name, const std::string& content, const Vector3& scale = kNoScale) {
    return loadTriangleMesh(directory_.write(name, content), scale);
  }
  std::string refusalOf(const std::string& name, const std::string& content, const Vector3& scale = kNoScale) {
    const std::string file = directory_.write(name, content);
    std::string message = refusal([&] { loadTriangleMesh(file, scale); });
    expectContains(message, {file});
    return message;
  }
  TemporaryDirectory directory_;
};

void expectTetrahedron(const TriangleMesh& mesh) {
  EXPECT_EQ(mesh.vertices.cols(), 4);  // merged: STL holds 12
  EXPECT_EQ(mesh.triangles.size(), 4u);
  EXPECT_TRUE(isClosedAndOriented(mesh));
  EXPECT_NEAR(enclosedVolume(mesh), 1.0, 1e-12);
  EXPECT_TRUE(mesh.vertices.rowwise().maxCoeff().isApprox(Vector3(1, 2, 3)));
}

TEST_F(LoadTriangleMesh, AsciiStl) { expectTetrahedron(load("a.stl", asciiStl())); }
TEST_F(LoadTriangleMesh, BinaryStl) { expectTetrahedron(load("a.stl", binaryStl())); }
TEST_F(LoadTriangleMesh, UpperCaseExtension) { expectTetrahedron(load("a.STL", binaryStl())); }
TEST_F(LoadTriangleMesh, Obj) { expectTetrahedron(load("a.obj", obj())); }
TEST_F(LoadTriangleMesh, FilesAsSomeProgramsWriteThem) {
  std::string capitals = asciiStl();
  std::transform(capitals.begin(), capitals.end(), capitals.begin(),
                 [](unsigned char c) { return static_cast<char>(std::toupper(c)); });
  expectTetrahedron(load("a.stl", capitals));
  std::string mixed = asciiStl();
  mixed.replace(mixed.find("facet"), 5, "Facet");
  expectTetrahedron(load("e.stl", mixed));
  expectTetrahedron(load("b.stl", binaryStl() + "written by a program"));
  std::string header = binaryStl();
  header.replace(0, 20, "SOLID WITH 4 FACETS ");
  expectTetrahedron(load("f.stl", header));
  expectContains(refusalOf("g.stl", binaryStl() + binaryStl()), {"cannot be read"});  // which may be another part
  expectTetrahedron(load("c.obj", "\xEF\xBB\xBF" + obj()));
  expectContains(refusalOf("d.stl", binaryStl().substr(0, binaryStl().size() - 1)), {"cannot be read"});
}
TEST_F(LoadTriangleMesh, Dae) {
  expectTetrahedron(load("a.dae", dae("1", "Z_UP", "<node><instance_geometry url=\"#g\"/></node>")));
}

TEST_F(LoadTriangleMesh, PointersOfLfsAndAnnexAreCalledThat) {
  const std::string lfs =
      "version https://git-lfs.github.com/spec/v1\noid sha256:4d7a214614ab2935c943f9e0ff69d22e\nsize 9\n";
  for (const char* name : {"a.stl", "a.dae", "a.obj"})
    expectContains(refusalOf(name, lfs), {"git-lfs", "git lfs pull"});
  const std::string annex = "/annex/objects/SHA256E-s9--4d7a.stl\n";
  expectContains(refusalOf("b.stl", annex), {"git-annex", "git annex get"});
  const std::string link = directory_.path("c.stl");
  std::filesystem::create_symlink(".git/annex/objects/Xx/SHA256E-s9--4d7a.stl", link);
  expectContains(refusal([&] { loadTriangleMesh(link, kNoScale); }), {link, "git annex get"});
}

TEST_F(LoadTriangleMesh, ObjPolygonsAreCutIntoTriangles) {
  const TriangleMesh mesh = load("a.obj",
                                 "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 0 1\nv 1 0 1\nv 1 1 1\nv 0 1 1\n"
                                 "f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n");
  EXPECT_EQ(mesh.triangles.size(), 12u);
  EXPECT_TRUE(isClosedAndOriented(mesh));
  EXPECT_NEAR(enclosedVolume(mesh), 1.0, 1e-12);
}

// An I-beam. As assimp 5.2.5 triangulates it, nine edges are open, and sheets lie across both recesses: area 27.5 instead of 25.
TEST_F(LoadTriangleMesh, ConcavePolygonsAreCutInside) {
  const std::vector<Vector2> outline = {{0, 0}, {3, 0}, {3, .5},  {1.75, .5},  {1.75, 2.5}, {3, 2.5},
                                        {3, 3}, {0, 3}, {0, 2.5}, {1.25, 2.5}, {1.25, .5},  {0, .5}};
  const std::size_t count = outline.size();
  std::ostringstream text;
  for (int z = 0; z < 2; ++z) {
    for (const Vector2& p : outline) text << "v " << p.x() << " " << p.y() << " " << z << "\n";
  }
  text << "f";
  for (std::size_t i = count; i > 0; --i) text << " " << i;
  text << "\nf";
  for (std::size_t i = 1; i <= count; ++i) text << " " << count + i;
  for (std::size_t i = 0; i < count; ++i) {
    const std::size_t next = (i + 1) % count + 1;
    text << "\nf " << i + 1 << " " << next << " " << count + next << " " << count + i + 1;
  }
  const TriangleMesh mesh = load("a.obj", text.str() + "\n");
  EXPECT_EQ(mesh.triangles.size(), 4 * count - 4);
  EXPECT_TRUE(isClosedAndOriented(mesh));
  EXPECT_NEAR(enclosedVolume(mesh), 4.0, 1e-6);
  double area = 0.0;
  for (const Triangle& t : mesh.triangles) area += triangleArea(mesh.vertices, t);
  EXPECT_NEAR(area, 25.0, 1e-6);
}

TEST_F(LoadTriangleMesh, ScaleMultipliesEveryAxis) {
  const TriangleMesh mesh = load("a.stl", binaryStl(), Vector3(0.001, 0.002, 0.5));
  EXPECT_TRUE(mesh.vertices.rowwise().maxCoeff().isApprox(Vector3(0.001, 0.004, 1.5), 1e-12));
  EXPECT_NEAR(enclosedVolume(mesh), 1e-6, 1e-15);
}

TEST_F(LoadTriangleMesh, NegativeScaleMirrorsAndStaysOutward) {
  const TriangleMesh mesh = load("a.stl", binaryStl(), Vector3(-1, 1, 1));
  EXPECT_NEAR(mesh.vertices.row(0).minCoeff(), -1.0, 1e-12);
  EXPECT_TRUE(isClosedAndOriented(mesh));
  EXPECT_NEAR(enclosedVolume(mesh), 1.0, 1e-12);
}

TEST_F(LoadTriangleMesh, InsideOutIsTurned) {
  TetrahedronShape shape;
  for (Triangle& t : shape.triangles) std::swap(t[0], t[1]);
  expectTetrahedron(load("a.stl", binaryStl(shape)));
}

TEST_F(LoadTriangleMesh, MixedOrientationIsMadeOne) {
  TetrahedronShape shape;
  std::swap(shape.triangles[2][0], shape.triangles[2][1]);
  expectTetrahedron(load("a.stl", binaryStl(shape)));
  std::swap(shape.triangles[0][0], shape.triangles[0][1]);
  std::swap(shape.triangles[3][0], shape.triangles[3][1]);
  expectTetrahedron(load("b.stl", binaryStl(shape)));
}

TEST_F(LoadTriangleMesh, OrientationIsRightFarFromTheOrigin) {
  TetrahedronShape shape;
  for (Vector3& p : shape.vertices) p += Vector3(-64, -64, -64);
  for (Triangle& t : shape.triangles) std::swap(t[0], t[1]);
  EXPECT_NEAR(enclosedVolume(load("a.obj", obj(shape))), 1.0, 1e-9);
}

TEST_F(LoadTriangleMesh, EachClosedPartIsOrientedForItself) {
  TetrahedronShape shape;
  for (int i = 0; i < 4; ++i) {
    shape.vertices.push_back(shape.vertices[static_cast<std::size_t>(i)] + Vector3(10, 0, 0));
    Triangle t = shape.triangles[static_cast<std::size_t>(i)];
    shape.triangles.push_back({t[1] + 4, t[0] + 4, t[2] + 4});
  }
  const TriangleMesh mesh = load("a.stl", binaryStl(shape));
  EXPECT_EQ(mesh.triangles.size(), 8u);
  EXPECT_TRUE(isClosedAndOriented(mesh));
  EXPECT_NEAR(enclosedVolume(mesh), 2.0, 1e-6);
}

TEST_F(LoadTriangleMesh, OpenSurfacesKeepTheirOrientation) {
  // Two triangles that disagree: nothing tells which side is outside, so both stay.
  const TriangleMesh mesh = load("a.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3\nf 1 4 3\n");
  ASSERT_EQ(mesh.triangles.size(), 2u);
  const auto normal = [&](std::size_t i) {
    const Triangle& t = mesh.triangles[i];
    return Vector3(
        (mesh.vertices.col(t[1]) - mesh.vertices.col(t[0])).cross(mesh.vertices.col(t[2]) - mesh.vertices.col(t[0])));
  };
  EXPECT_GT(normal(0).z(), 0.0);
  EXPECT_LT(normal(1).z(), 0.0);
}

TEST_F(LoadTriangleMesh, VerticesThatDifferInTheLastDigitAreMerged) {
  TetrahedronShape shape;
  shape.vertices.emplace_back(1.0 + 1e-7, 0, 0);  // one float beside vertex 1
  shape.triangles[3] = {4, 2, 3};
  expectTetrahedron(load("a.stl", binaryStl(shape)));
}

TEST_F(LoadTriangleMesh, DistinctVerticesOfATinyMeshStayApart) {
  // The merging distance follows the size of the mesh: nanometres are not "zero".
  TetrahedronShape shape;
  for (Vector3& p : shape.vertices) p *= 1e-9;
  const TriangleMesh mesh = load("a.stl", binaryStl(shape));
  EXPECT_EQ(mesh.vertices.cols(), 4);
  EXPECT_NEAR(enclosedVolume(mesh) / 1e-27, 1.0, 1e-6);
}

TEST_F(LoadTriangleMesh, DegenerateTrianglesAndStrayVerticesAreDropped) {
  TetrahedronShape shape;
  shape.vertices.emplace_back(0.5, 0, 0);
  shape.vertices.emplace_back(0.25, 0.25, 0.25);
  shape.triangles.push_back({0, 4, 1});  // on a line
  shape.triangles.push_back({1, 1, 2});  // two equal corners
  shape.triangles.push_back({5, 5, 5});  // a point
  expectTetrahedron(load("a.stl", binaryStl(shape)));
}

TEST_F(LoadTriangleMesh, DaeAppliesUnitAndNodeTransforms) {
  const TriangleMesh mesh = load("a.dae", dae("0.001", "Z_UP",
                                              "<node><translate>10 0 0</translate><node><rotate>0 0 1 90</rotate>"
                                              "<scale>2 2 2</scale><instance_geometry url=\"#g\"/></node></node>"));
  // (1, 2, 3) doubled, turned about z, moved by 10 mm: x in 10 - 4 ... 10, y in 0 ... 2, z in 0 ... 6.
  EXPECT_TRUE(mesh.vertices.rowwise().maxCoeff().isApprox(Vector3(0.010, 0.002, 0.006), 1e-6));
  EXPECT_NEAR(mesh.vertices.row(0).minCoeff(), 0.006, 1e-8);
  EXPECT_NEAR(enclosedVolume(mesh), 8e-9, 1e-14);
}

TEST_F(LoadTriangleMesh, DaeUpAxisIsIgnoredAsInRviz) {
  for (const char* up : {"X_UP", "Y_UP", "Z_UP"}) {
    SCOPED_TRACE(up);
    expectTetrahedron(load("a.dae", dae("1", up, "<node><instance_geometry url=\"#g\"/></node>")));
  }
}

TEST_F(LoadTriangleMesh, DaeMirroredNodesStayOutward) {
  const TriangleMesh mesh =
      load("a.dae", dae("1", "Z_UP", "<node><scale>-1 1 1</scale><instance_geometry url=\"#g\"/></node>"));
  EXPECT_NEAR(mesh.vertices.row(0).minCoeff(), -1.0, 1e-12);
  EXPECT_NEAR(enclosedVolume(mesh), 1.0, 1e-9);
}

TEST_F(LoadTriangleMesh, DaeInstancesAreCopied) {
  const std::string library = "<library_nodes><node id=\"part\"><instance_geometry url=\"#g\"/></node></library_nodes>";
  const TriangleMesh mesh = load("a.dae", dae("1", "Z_UP",
                                              "<node id=\"x\"><instance_node url=\"#part\"/></node><node "
                                              "id=\"y\"><translate>5 0 0</translate><instance_node "
                                              "url=\"#part\"/></node>",
                                              library));
  EXPECT_EQ(mesh.triangles.size(), 8u);
  EXPECT_NEAR(enclosedVolume(mesh), 2.0, 1e-6);
}

TEST_F(LoadTriangleMesh, RefusesWhatIsNoMeshFile) {
  const auto refused = [](const std::string& file) { return refusal([&] { loadTriangleMesh(file, kNoScale); }); };
  expectContains(refused(directory_.path("none.stl")), {"none.stl", "does not exist"});
  expectContains(refused(directory_.path("")), {directory_.path(""), "not a regular file"});
  expectContains(refused("/dev/zero"), {"/dev/zero", "not a regular file"});
  expectContains(refusalOf("a.stl", ""), {"is empty"});
  expectContains(refusalOf("a.ply", "ply"), {"'.ply'", "use .stl, .obj or .dae"});
  expectContains(refusalOf("mesh", "x"), {"''", "use .stl, .obj or .dae"});
}

TEST_F(LoadTriangleMesh, RefusesUnreadableContent) {
  expectContains(refusalOf("a.stl", "hello"), {"cannot be read"});
  expectContains(refusalOf("a.stl", binaryStl().substr(0, 150)), {"cannot be read"});
  expectContains(refusalOf("a.obj", "hello\n"), {"a.obj"});
  expectContains(refusalOf("a.obj", "v 0 0 0\nv 1 0 0\nf 1 2 9\n"), {"a.obj"});
  expectContains(refusalOf("a.dae", "hello"), {"cannot be read"});
  expectContains(refusalOf("a.dae", "<COLLADA>\n<a></COLLADA>"), {"cannot be read"});
}

TEST_F(LoadTriangleMesh, RefusesMeshesWithoutTriangles) {
  expectContains(refusalOf("a.stl", "solid x\nendsolid x\n"), {"a.stl"});
  expectContains(refusalOf("a.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\n"), {"a.obj"});
  expectContains(refusalOf("a.obj", "v 0 0 0\nv 1 0 0\nl 1 2\n"), {"has no triangles"});
  expectContains(refusalOf("a.dae", dae("1", "Z_UP", "<node/>")), {"a.dae"});
  expectContains(refusalOf("a.obj", "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n"), {"degenerate triangles only"});
  expectContains(refusalOf("a.obj", "v 1 1 1\nv 1 1 1\nv 1 1 1\nf 1 2 3\n"), {"degenerate triangles only"});
}

TEST_F(LoadTriangleMesh, RefusesVerticesThatAreNotFinite) {
  for (const double bad : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    TetrahedronShape shape;
    shape.vertices[2].y() = bad;
    expectContains(refusalOf("a.stl", binaryStl(shape)), {"not finite"});
  }
}

TEST_F(LoadTriangleMesh, RefusesBadScales) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const Vector3& scale : {Vector3(0, 1, 1), Vector3(1, nan, 1), Vector3(1, 1, 1 / 0.0)}) {
    expectContains(refusalOf("a.stl", binaryStl(), scale), {"scale", "zero or not finite", "0.001"});
  }
  expectContains(refusalOf("a.stl", binaryStl(), Vector3(1, 1e308, 1)), {"not finite after scaling"});
}

TEST_F(LoadTriangleMesh, MalformedDaeThatCrashesAssimpIsRefused) {
  // Recursion without end: nested nodes, and a node that contains itself.
  std::string deep;
  for (int i = 0; i < 100000; ++i) deep += "<node>";
  for (int i = 0; i < 100000; ++i) deep += "</node>";
  expectContains(refusalOf("deep.dae", dae("1", "Z_UP", deep)), {"cannot be read", "crashes"});
  const std::string use = "<node><instance_node url=\"#a\"/></node>";
  const std::string cycle = "<library_nodes><node id=\"a\"><instance_node url=\"#a\"/></node></library_nodes>";
  expectContains(refusalOf("cycle.dae", dae("1", "Z_UP", use, cycle)), {"cannot be read", "crashes"});
  // A null pointer: the attribute `count` is missing.
  std::string no_count = dae("1", "Z_UP", "<node><instance_geometry url=\"#g\"/></node>");
  no_count.replace(no_count.find("count=\"12\""), 10, "");
  expectContains(refusalOf("no_count.dae", no_count), {"cannot be read"});
}

TEST_F(LoadTriangleMesh, MalformedDaeThatMakesAssimpAllocateWithoutEndIsRefused) {
#ifdef __SANITIZE_ADDRESS__
  GTEST_SKIP() << "the address sanitizer reports where memory ends, and throws no std::bad_alloc";
#endif
  std::string text = dae("1", "Z_UP", "<node><instance_geometry url=\"#g\"/></node>");
  text.replace(text.find("<p>0 2 1"), 8, "<p>0 x 1");
  expectContains(refusalOf("endless.dae", text), {"cannot be read", "too much memory"});
}

TEST_F(LoadTriangleMesh, OtherFilesNamedInAMeshWithAByteOrderMarkAreNotOpened) {
  const std::string pipe = directory_.path("pipe");
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);  // whoever opens it waits for ever
  expectTetrahedron(load("a.obj", "\xEF\xBB\xBFmtllib pipe\nmtllib " + pipe + "\nmtllib /dev/zero\n" + obj()));
}

TEST_F(LoadTriangleMesh, OtherFilesNamedInAMeshAreNotOpened) {
  // Opening the device would never end.
  expectTetrahedron(load("a.obj", "mtllib /dev/zero\n" + obj()));
}

}  // namespace triangle_mesh_test
}  // namespace tissue_contact
