/// Surfaces as some programs write them, and what is said of those that cannot be read.
#include <gtest/gtest.h>

#include <algorithm>
#include <string>

#include "mesh_fixture.h"
#include "tissue_contact/mesh/triangle_mesh.h"
#include "unit/instrument/instrument_fixture.h"

namespace tissue_contact {
namespace surface_bytes_test {

class SurfaceBytes : public testing::Test {
 protected:
  /// The tetrahedron of the fixture, whatever the file looks like.
  void expectRead(const std::string& name, const std::string& content) {
    SCOPED_TRACE(name);
    TriangleMesh mesh;
    ASSERT_NO_THROW(mesh = loadTriangleMesh(directory_.write(name, content), Vector3::Ones()));
    EXPECT_EQ(mesh.triangles.size(), 4U);
    EXPECT_TRUE(isClosedAndOriented(mesh));
    EXPECT_NEAR(enclosedVolume(mesh), 1.0, 1e-12);
  }
  TemporaryDirectory directory_;
};

std::string replaced(std::string text, const std::string& old, const std::string& by) {
  for (std::size_t at = text.find(old); at != std::string::npos; at = text.find(old, at + by.size())) {
    text.replace(at, old.size(), by);
  }
  return text;
}

/// Of the fixture, with these normals.
std::string stlWithNormals(const std::string& normal) {
  std::string text;
  const std::string plain = asciiStl();
  for (std::size_t at = 0; at < plain.size();) {
    const std::size_t end = plain.find('\n', at);
    const std::string line = plain.substr(at, end - at);
    text += (line.find("facet normal") == std::string::npos ? line : "facet normal " + normal) + "\n";
    at = end + 1;
  }
  return text;
}

// Refused before, "Cannot parse string "#IND -1.#IND ..." as a real number".
TEST_F(SurfaceBytes, NormalsThatAreNoNumbersDoNotMatter) {
  for (const char* word : {"-1.#IND", "1.#QNAN", "-nan(ind)", "nan"}) {
    const std::string text = stlWithNormals(std::string(word) + " " + word + " " + word);
    expectRead("a.stl", text);
    expectRead("b.stl", replaced(text, "\n", "\r\n"));
    expectRead("c.stl", replaced(replaced(text, "facet", "FACET"), "vertex", "VERTEX"));
    expectRead("d.stl", replaced(replaced(text, "\n", " "), "facet normal", "\nfacet normal") + "\n");
  }
}

// Its triangles were lost with the rest of their lines.
TEST_F(SurfaceBytes, ANameWithANumberLeavesFacetsOfOneLineAsTheyAre) {
  const std::string text = replaced(replaced(asciiStl(), "\n", " "), "facet normal", "\nfacet normal");
  expectRead("a.stl", text + " (2)\n");
  expectRead("b.stl", replaced(text, "endsolid", "\nendsolid Part (1)") + "\n");
}

// "Failed to determine STL storage representation", "Node name too long".
TEST_F(SurfaceBytes, StlStartsWhereItsFirstWordIs) {
  expectRead("a.stl", "\n" + asciiStl());
  expectRead("b.stl", "\xEF\xBB\xBF\r\n  " + asciiStl());
  const std::string rest = asciiStl().substr(asciiStl().find('\n'));
  expectRead("c.stl", "solid " + std::string(2000, 'n') + rest);
  expectRead("d.stl", "Solid " + std::string(2000, 'n') + replaced(rest, "facet", "Facet"));
}

// "OBJ: Invalid face index", "OBJ: vertex index out of range".
TEST_F(SurfaceBytes, CommentsAndColoursOfAnObjDoNotMatter) {
  std::string commented, coloured;
  const std::string plain = obj();
  for (std::size_t at = 0; at < plain.size();) {
    const std::size_t end = std::min(plain.find('\n', at), plain.size());
    const std::string line = plain.substr(at, end - at);
    commented += line + " # 1 of 2\n";
    coloured += line + (line[0] == 'v' ? " 0.1 0.2 0.3 1.0  \n" : "\n");
    at = end + 1;
  }
  expectRead("a.obj", commented);
  expectRead("b.obj", replaced(commented, "\n", "\r\n"));
  expectRead("c.obj", coloured);
}

// 180 kB of the file were quoted here, 44.8 MB of a file as large, in one line of the log.
TEST_F(SurfaceBytes, WhatIsSaidOfAFileIsShort) {
  std::string text = "solid a\n";
  for (int i = 0; i < 1000; ++i) {
    text +=
        "facet normal 0 0 1\n outer loop\n  vertex 0 0 0\n  vertex 1.#IND 0 0\n  vertex 0 1 0\n endloop\nendfacet\n";
  }
  const std::string file = directory_.write("a.stl", text + "endsolid a\n");
  const std::string message = refusal([&] { loadTriangleMesh(file, Vector3::Ones()); });
  EXPECT_LT(message.size(), 400U + file.size());
  expectContains(message, {file, "cannot be read", "#IND"});
  EXPECT_EQ(message.find('\n'), std::string::npos);
}

}  // namespace surface_bytes_test
}  // namespace tissue_contact
