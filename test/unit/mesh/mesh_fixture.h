/// @file
/// Small mesh files for the tests of the room `instrument`, written as text, and measures of what was read.
#pragma once

#include <cstdint>
#include <cstring>
#include <map>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

#include "tissue_contact/mesh/triangle_mesh.h"

namespace tissue_contact {

/// A tetrahedron with legs 1, 2, 3 along the axes: volume 1; triangles outward.
struct TetrahedronShape {
  std::vector<Vector3> vertices = {{0, 0, 0}, {1, 0, 0}, {0, 2, 0}, {0, 0, 3}};
  std::vector<Triangle> triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
};

inline std::string asciiStl(const TetrahedronShape& shape = {}) {
  std::ostringstream text;
  text << "solid test\n";
  for (const Triangle& t : shape.triangles) {
    text << "facet normal 0 0 0\n outer loop\n";
    for (const int v : t) text << "  vertex " << shape.vertices[static_cast<std::size_t>(v)].transpose() << "\n";
    text << " endloop\nendfacet\n";
  }
  text << "endsolid test\n";
  return text.str();
}

inline std::string binaryStl(const TetrahedronShape& shape = {}) {
  std::string bytes(80, ' ');
  const auto append = [&bytes](const void* data, std::size_t size) {
    bytes.append(static_cast<const char*>(data), size);
  };
  const auto count = static_cast<std::uint32_t>(shape.triangles.size());
  append(&count, sizeof count);
  for (const Triangle& t : shape.triangles) {
    float values[12] = {0, 0, 0};
    for (int k = 0; k < 9; ++k) {
      const auto v = static_cast<std::size_t>(t[static_cast<std::size_t>(k / 3)]);
      values[3 + k] = static_cast<float>(shape.vertices[v][k % 3]);
    }
    append(values, sizeof values);
    bytes += std::string(2, '\0');
  }
  return bytes;
}

inline std::string obj(const TetrahedronShape& shape = {}) {
  std::ostringstream text;
  for (const Vector3& p : shape.vertices) text << "v " << p.transpose() << "\n";
  for (const Triangle& t : shape.triangles) text << "f " << t[0] + 1 << " " << t[1] + 1 << " " << t[2] + 1 << "\n";
  return text.str();
}

/// @param meter length of the file's unit, m. @param nodes content of the <visual_scene>; "#g" is the geometry.
inline std::string dae(const std::string& meter, const std::string& up_axis, const std::string& nodes,
                       const std::string& libraries = "") {
  return "<?xml version=\"1.0\"?>\n<COLLADA xmlns=\"http://www.collada.org/2005/11/COLLADASchema\" version=\"1.4.1\">"
         "<asset><unit name=\"u\" meter=\"" +
         meter + "\"/><up_axis>" + up_axis +
         "</up_axis></asset>\n<library_geometries><geometry id=\"g\"><mesh><source id=\"p\"><float_array id=\"pa\" "
         "count=\"12\">0 0 0 1 0 0 0 2 0 0 0 3</float_array><technique_common><accessor source=\"#pa\" count=\"4\" "
         "stride=\"3\"><param name=\"X\" type=\"float\"/><param name=\"Y\" type=\"float\"/><param name=\"Z\" "
         "type=\"float\"/></accessor></technique_common></source><vertices id=\"v\"><input semantic=\"POSITION\" "
         "source=\"#p\"/></vertices><triangles count=\"4\"><input semantic=\"VERTEX\" source=\"#v\" offset=\"0\"/>"
         "<p>0 2 1 0 1 3 0 3 2 1 2 3</p></triangles></mesh></geometry></library_geometries>\n" +
         libraries + "<library_visual_scenes><visual_scene id=\"s\">" + nodes +
         "</visual_scene></library_visual_scenes><scene><instance_visual_scene url=\"#s\"/></scene></COLLADA>";
}

/// Signed volume enclosed by the triangles.
inline double enclosedVolume(const TriangleMesh& mesh) {
  double volume = 0.0;
  for (const Triangle& t : mesh.triangles) {
    volume += mesh.vertices.col(t[0]).cross(mesh.vertices.col(t[1])).dot(mesh.vertices.col(t[2])) / 6.0;
  }
  return volume;
}

/// Every directed side occurs once and its opposite once.
inline bool isClosedAndOriented(const TriangleMesh& mesh) {
  std::map<std::pair<int, int>, int> sides;
  for (const Triangle& t : mesh.triangles) {
    for (std::size_t k = 0; k < 3; ++k) ++sides[{t[k], t[(k + 1) % 3]}];
  }
  for (const auto& [side, count] : sides) {
    const auto opposite = sides.find({side.second, side.first});
    if (count != 1 || opposite == sides.end() || opposite->second != 1) return false;
  }
  return !sides.empty();
}

}  // namespace tissue_contact
