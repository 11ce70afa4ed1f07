#include "tissue_contact/tissue/tissue.h"

#include "tissue_contact/core/check.h"
#include "tissue_contact/tissue/tet_elasticity.h"

namespace tissue_contact {

struct Tissue::PlacedMesh {
  TetMesh mesh;  // in the world frame
  std::vector<bool> fixed;
};

namespace {

VectorX lumpedMasses(const TetMesh& mesh, double density) {
  VectorX masses = VectorX::Zero(mesh.positions.cols());
  for (const Tetrahedron& tet : mesh.tetrahedra) {
    const double quarter = 0.25 * density * signedVolume(mesh.positions, tet);
    for (const int node : tet) masses[node] += quarter;
  }
  return masses;
}

}  // namespace

Tissue::PlacedMesh Tissue::placeMesh(const TissueDescription& description, const Pose& X_WT) {
  const std::string source = "tissue '" + description.name + "'";
  PlacedMesh placed;
  if (const auto* block = std::get_if<BlockDescription>(&description.geometry)) {
    placed.mesh = makeBlockMesh(*block);
    checkTetMesh(placed.mesh, source);
  } else {
    const auto& file = std::get<MeshDescription>(description.geometry);
    placed.mesh = loadTetMesh(file);
    checkTetMesh(placed.mesh, source + ", mesh file '" + file.file + "'");
  }
  placed.fixed = fixedNodes(placed.mesh.positions, description.fixed, source);  // regions are in the tissue frame
  placed.mesh.positions = (X_WT.linear() * placed.mesh.positions).colwise() + X_WT.translation();
  return placed;
}

Tissue::Tissue(const TissueDescription& description, const Pose& X_WT)
    : Tissue(description, placeMesh(description, X_WT)) {}

Tissue::Tissue(const TissueDescription& description, const PlacedMesh& placed)
    : name_(description.name),
      rest_(placed.mesh.positions),
      tetrahedra_(placed.mesh.tetrahedra),
      surface_(boundaryTriangles(placed.mesh.tetrahedra)),
      fixed_(placed.fixed),
      masses_(lumpedMasses(placed.mesh, requirePositive("tissue '" + description.name + "': density_kg_per_m3",
                                                        description.material.density_kg_per_m3, "kg/m^3"))),
      damping_(description.damping),
      elasticity_(std::make_unique<TetElasticity>(placed.mesh.positions, placed.mesh.tetrahedra, placed.fixed,
                                                  description.material)) {
  requireNonNegative("tissue '" + name_ + "': damping mass_per_s", damping_.mass_per_s, "1/s");
  requireNonNegative("tissue '" + name_ + "': damping stiffness_s", damping_.stiffness_s, "s");
}

}  // namespace tissue_contact
