#include <algorithm>
#include <cctype>
#include <cstdint>
#include <filesystem>
#include <stdexcept>
#include <string>
#include <utility>

#include "mesh/nodes.h"
#include "mesh/reader/assimp_reader.h"
#include "mesh/reader/flat_triangles.h"
#include "mesh/reader/mesh_cleanup.h"
#include "tissue_contact/core/read_file.h"
#include "tissue_contact/mesh/triangle_mesh.h"

namespace tissue_contact {
namespace {

[[noreturn]] void refuseFile(const std::string& file, const std::string& what) {
  throw std::invalid_argument("mesh file '" + file + "' " + what);
}

void checkExtension(const std::string& file) {
  const std::string extension = std::filesystem::path(file).extension().string();
  std::string lower = extension;
  std::transform(lower.begin(), lower.end(), lower.begin(),
                 [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
  if (lower != ".stl" && lower != ".obj" && lower != ".dae") {
    refuseFile(file, "has the extension '" + extension + "'; use .stl, .obj or .dae");
  }
}

void applyScale(const Vector3& scale, const std::string& file, TriangleMesh& mesh) {
  mesh.vertices = scale.asDiagonal() * mesh.vertices;
  if (!mesh.vertices.allFinite()) refuseFile(file, "has vertices that are not finite after scaling");
  if (scale.prod() < 0.0) {  // a mirror turns the triangles inside out
    for (Triangle& triangle : mesh.triangles) std::swap(triangle[1], triangle[2]);
  }
}

}  // namespace

TriangleMesh loadTriangleMesh(const std::string& file, const Vector3& scale) {
  requireRegularFile(file, "mesh file", kMaxSurfaceBytes);
  checkExtension(file);
  if (!scale.allFinite() || !(scale.array() != 0.0).all()) {
    refuseFile(file, "has a scale that is zero or not finite; use e.g. 0.001 0.001 0.001 for a file in millimetres");
  }
  const TriangleSoup soup = readTriangleSoup(file);
  if (soup.triangles.empty()) refuseFile(file, "has no triangles");
  TriangleMesh mesh = mergeVertices(soup.vertices, soup.triangles);
  orientOutward(mesh);
  absorbFlatTriangles(mesh);
  dropFlatTriangles(mesh);
  dropUnusedNodes(mesh.vertices, mesh.triangles);
  if (mesh.triangles.empty()) refuseFile(file, "has degenerate triangles only");
  applyScale(scale, file, mesh);
  return mesh;
}

}  // namespace tissue_contact
