/// @file
/// Tetrahedral meshes: Gmsh .msh and legacy VTK, as a tissue reads them.
#include <stdexcept>

#include "fuzz/fuzz_support.h"
#include "tissue_contact/mesh/tet_mesh.h"

using namespace tissue_contact;

namespace {

void checkRead(const TetMesh& mesh) {
  fuzz::require(!mesh.tetrahedra.empty() && mesh.positions.allFinite(), "a mesh that was read has finite tetrahedra");
  for (const Tetrahedron& tet : mesh.tetrahedra) {
    for (const int node : tet) fuzz::require(node >= 0 && node < mesh.positions.cols(), "node indices in range");
  }
}

/// What a tissue does with a mesh next.
void use(const TetMesh& mesh) {
  checkTetMesh(mesh, "input");
  const std::vector<Triangle> surface = boundaryTriangles(mesh.tetrahedra);
  fuzz::require(!surface.empty(), "a checked mesh has a surface");
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static fuzz::InputFile file;
  MeshDescription description;
  description.file = file.hold("input.msh", fuzz::textOf(data, size));
  for (const bool remove : {false, true}) {
    description.remove_unreferenced_nodes = remove;
    try {
      const TetMesh mesh = loadTetMesh(description);
      checkRead(mesh);
      use(mesh);
    } catch (const std::invalid_argument&) {
    }
  }
  return 0;
}
