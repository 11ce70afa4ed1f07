/// @file
/// Room `mesh`: loadTetMesh: file and scale in, tetrahedral mesh in metres out; the formats are in gmsh_*.cpp,
/// vtk_*.cpp.
///
/// Own readers, on purpose. Gmsh's library is GPL-2+, loads 91 shared libraries at each start, and its VTK reader drops
/// unreferenced nodes in silence, whereas a user must learn which they are. VTK is larger still. Neither bounds what a
/// damaged file makes it allocate nor names the line or byte at fault.
#include "mesh/reader/mesh_file.h"

#include <cmath>
#include <cstdint>
#include <stdexcept>
#include <string>
#include <utility>

#include "mesh/fill/fill_surface.h"
#include "mesh/nodes.h"
#include "mesh/orientation.h"
#include "tissue_contact/core/check.h"
#include "tissue_contact/core/read_file.h"
#include "tissue_contact/mesh/tet_mesh.h"

namespace tissue_contact {
namespace {

// Two million tetrahedra, the most a scene may have, take 100 MB as text. What is read from so many bytes is at most four
// times as large.
constexpr std::uintmax_t kMaximumFileBytes = std::uintmax_t{256} << 20U;

MeshFileContents readContents(const std::string& file, bool with_labels) {
  std::string bytes = readFile(file, "mesh file", kMaximumFileBytes);
  const bool gmsh = !bytes.empty() && bytes[0] == '$';
  const bool vtk = bytes.rfind("# vtk ", 0) == 0;
  const bool xml = !bytes.empty() && bytes[0] == '<';
  const std::string start = excerpt(std::string_view(bytes).substr(0, bytes.find_first_of("\r\n")));
  MeshFileCursor in(file, std::move(bytes));
  if (gmsh) return readGmsh(in, with_labels);
  if (vtk) return readVtk(in, with_labels);
  if (in.atEnd()) in.fail("the file is empty; it must hold a Gmsh .msh or a legacy VTK mesh");
  in.fail("the file starts with " + start +
          ", which is neither Gmsh .msh ('$MeshFormat' or '$NOD') nor legacy VTK ('# vtk DataFile Version')" +
          (xml ? "; XML is not read" : "") + "; convert it, for instance: meshio convert FILE organ.vtk");
}

void requireTetrahedra(const MeshFileContents& contents, const std::string& file) {
  if (contents.other_volumes > 0) {
    throw std::invalid_argument(
        "mesh file '" + file + "' holds " + std::to_string(contents.other_volumes) +
        " hexahedra, prisms or pyramids, which would be missing; split them into tetrahedra, for "
        "instance with ParaView's filter Tetrahedralize");
  }
  if (!contents.tetrahedra.empty()) return;
  throw std::invalid_argument("mesh file '" + file + "' holds no tetrahedra (" + std::to_string(contents.nodes.size()) +
                              " nodes, " + std::to_string(contents.other_elements) +
                              " elements of other kinds); mesh its volume, or save a closed surface as .stl (meshio "
                              "convert FILE organ.stl), which is filled");
}

/// In metres, from the file's unit.
void scale(const MeshDescription& description, NodalVectors& positions) {
  positions *= description.scale_m_per_unit;
  for (Eigen::Index i = 0; i < positions.cols(); ++i) {
    if (positions.col(i).allFinite()) continue;
    throw std::invalid_argument("mesh file '" + description.file + "': node " + std::to_string(i) +
                                " is not finite after scaling; reduce scale_m_per_unit");
  }
}

}  // namespace

Vector3 readNode(MeshFileCursor& in, int bytes, std::size_t index) {
  static constexpr const char* kNames[] = {"a node's x", "a node's y", "a node's z"};
  Vector3 node;
  for (Eigen::Index axis = 0; axis < 3; ++axis) {
    node[axis] = in.real(bytes, kNames[axis]);
    if (!std::isfinite(node[axis])) {
      in.fail("node " + std::to_string(index) + " (0-based, in file order) has the coordinate " +
              std::to_string(node[axis]) + "; coordinates must be finite: repair the mesh");
    }
  }
  return node;
}

TetMesh loadTetMesh(const MeshDescription& description, const MeshPreparation& preparation, MeshLabels* labels) {
  if (description.cell_size_m != 0.0) return fillSurface(description, preparation);
  requirePositive("scale_m_per_unit of mesh file '" + description.file + "'", description.scale_m_per_unit, "m");
  MeshFileContents contents = readContents(description.file, labels != nullptr);
  requireTetrahedra(contents, description.file);
  TetMesh mesh{columnsOf(contents.nodes), std::move(contents.tetrahedra)};
  if (labels != nullptr) {
    *labels = {mesh.positions * description.scale_m_per_unit, std::move(contents.groups),
               std::move(contents.cell_data)};
  }
  if (description.remove_unreferenced_nodes) {
    dropUnusedNodes(mesh.positions, mesh.tetrahedra);
  } else if (!contents.between_corners.empty()) {
    dropUnusedNodes(mesh.positions, mesh.tetrahedra, &contents.between_corners);
  }
  scale(description, mesh.positions);
  const std::size_t turned = turnTetrahedra(mesh);
  const auto say = [&](std::size_t count, const char* what) {
    if (count == 0 || !preparation.say) return;
    preparation.say("mesh file '" + description.file + "': " + std::to_string(count) + " of " +
                    std::to_string(mesh.tetrahedra.size()) + " tetrahedra " + what);
  };
  say(contents.higher_order, "are of higher order; their corners are taken, with straight edges");
  say(turned, "are numbered the other way round, and turned");
  return mesh;
}

}  // namespace tissue_contact
