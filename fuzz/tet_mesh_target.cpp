/// @file
/// Tetrahedral meshes: Gmsh .msh and legacy VTK, as a tissue reads them.
#include <algorithm>
#include <array>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include "fuzz/fuzz_support.h"
#include "mesh/labels.h"
#include "tissue/placed_mesh.h"
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

/// Meshes get through or are refused, but of many that were read some must get through:
/// or else this target tests nothing of what follows.
struct Counts {
  int read = 0;
  int followed = 0;

  ~Counts() {
    fuzz::require(read < 30 || followed > read / 20, "a twentieth of the meshes that were read follow tools");
  }
};

/// A tissue of the mesh that follows tools, held and with a region somewhere in it.
void follow(const MeshDescription& file, const TetMesh& mesh) {
  const Vector3 low = mesh.positions.rowwise().minCoeff();
  const Vector3 middle = 0.5 * (low + mesh.positions.rowwise().maxCoeff());
  TissueDescription tissue;
  tissue.name = "input";
  tissue.geometry = file;
  tissue.material = {ElasticModel::kCorotational, 5e3, 0.45, 1000.0};
  tissue.refinement.mode = RefinementDescription::Mode::kAuto;
  tissue.fixed = {PlaneRegion{0.7 * low + 0.3 * middle, Vector3(0.0, 0.2, 1.0)}};
  TissueRegion part;
  part.name = "part";
  part.where = {SphereRegion{middle, 0.1 * (middle - low).norm()}};
  part.material = tissue.material;
  tissue.regions = {part};
  RefinableMesh made = refinableMesh(tissue, nullptr, {});
  BisectedMesh refined;
  const auto most = static_cast<std::size_t>(std::max(3000L, static_cast<long>(mesh.positions.cols()) * 3 / 2));
  const auto unlimited = [](const Vector3&) { return std::numeric_limits<double>::infinity(); };
  fuzz::require(made.bisection.refine(unlimited, most, refined), "the mesh that nothing touches has nodes to spare");
  fuzz::require(made.body_coarsening >= 1.0, "cells are as long as asked for or longer");
  placeMesh(made.description, Pose::Identity(), refined);
}

/// What the file calls its parts, as regions of a scene would name them: some hold a node, others are refused.
void useLabels(const TetMesh& mesh, const MeshLabels& labels) {
  std::vector<Region> regions;
  for (const MeshLabels::Group& group : labels.groups) {
    for (const std::array<int, 4>& element : group.elements) {
      for (const int node : element) fuzz::require(node >= -1 && node < labels.nodes.cols(), "group nodes in range");
    }
    regions.emplace_back(GroupRegion{group.name.empty() ? std::to_string(group.number) : group.name});
  }
  for (const MeshLabels::CellData& data : labels.cell_data) {
    fuzz::require(labels.volume_of.size() == mesh.tetrahedra.size(), "a volume for each tetrahedron");
    for (const int volume : labels.volume_of) {
      fuzz::require(volume >= 0 && static_cast<std::size_t>(volume) < data.values.size(), "a number for each volume");
    }
    regions.emplace_back(CellDataRegion{data.name, data.values.front()});
  }
  for (const Region& region : regions) {
    try {
      fixedNodes(mesh.positions, withPlaces({region}, labels, mesh, "fixed", "input"), "input");
    } catch (const std::invalid_argument&) {
    }
  }
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  static fuzz::InputFile file;
  static Counts counts;
  MeshDescription description;
  description.file = file.hold("input.msh", fuzz::textOf(data, size));
  for (const CoincidentNodes treatment : {CoincidentNodes::kRefuse, CoincidentNodes::kMerge, CoincidentNodes::kKeep}) {
    description.remove_unreferenced_nodes = treatment != CoincidentNodes::kRefuse;
    description.coincident_nodes = treatment;
    try {
      const TetMesh mesh = loadTetMesh(description);
      checkRead(mesh);
      use(mesh);
      MeshLabels labels;
      useLabels(loadTetMesh(description, {}, &labels), labels);
      if (treatment != CoincidentNodes::kMerge) continue;  // once is enough: it takes longer than all else
      ++counts.read;
      follow(description, mesh);
      ++counts.followed;
    } catch (const std::invalid_argument&) {
    }
  }
  return 0;
}
