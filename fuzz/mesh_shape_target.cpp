/// @file
/// Surfaces of robot models once their file is read (robot_mesh_target.cpp): vertices merged, oriented, cleaned, and sampled
/// into a distance field. The input is a triangle soup on a coarse lattice, so that coincident, flat and crossing triangles
/// are common.
#include <algorithm>
#include <stdexcept>

#include "contact/shape/mesh_field.h"
#include "fuzz/fuzz_support.h"
#include "mesh/nodes.h"
#include "mesh/reader/mesh_cleanup.h"

using namespace tissue_contact;

namespace {

constexpr int kMostTriangles = 200;
constexpr double kSamples = 2000.0;

void check(const TriangleMesh& mesh) {
  fuzz::require(mesh.vertices.allFinite(), "finite vertices");
  for (const Triangle& triangle : mesh.triangles) {
    for (const int vertex : triangle) fuzz::require(vertex >= 0 && vertex < mesh.vertices.cols(), "indices in range");
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::Bytes bytes(data, size);
  constexpr double kScales[] = {1e-3, 1e-3, 1e-3, 1e-6, 1.0, 1e6, 1e-150, 1e150};
  const double scale = kScales[bytes.take<std::uint8_t>() % 8];
  const bool shared = bytes.take<std::uint8_t>() % 2 == 0;  // an index per corner, or three vertices of its own
  std::vector<Vector3> vertices;
  std::vector<Triangle> triangles;
  const int vertex_count = shared ? 4 + bytes.take<std::uint8_t>() % 60 : 0;
  const auto addVertex = [&] {
    const auto x = bytes.take<std::int8_t>(), y = bytes.take<std::int8_t>(), z = bytes.take<std::int8_t>();
    vertices.emplace_back(scale * Vector3(x, y, z));
  };
  for (int i = 0; i < vertex_count; ++i) addVertex();
  while (bytes.left() >= 3 && triangles.size() < kMostTriangles) {
    const auto first = static_cast<int>(vertices.size());
    Triangle triangle{first, first + 1, first + 2};
    for (int& corner : triangle) {
      if (shared) corner = bytes.take<std::uint8_t>() % vertex_count;
      if (!shared) addVertex();
    }
    triangles.push_back(triangle);
  }
  try {
    TriangleMesh mesh = mergeVertices(vertices, triangles);
    orientOutward(mesh);
    dropFlatTriangles(mesh);
    dropUnusedNodes(mesh.vertices, mesh.triangles);
    check(mesh);
    if (mesh.triangles.empty()) return 0;
    MeshPreparation no_cache;
    const std::shared_ptr<const MeshField> field = prepareMeshField(mesh, "input", no_cache, kSamples);
    fuzz::require(field != nullptr && field->low.allFinite() && field->high.allFinite(), "a field with finite bounds");
  } catch (const std::invalid_argument&) {
  }
  return 0;
}
