/// @file
/// Room `mesh`: loadTetMesh: file and scale in, tetrahedral mesh in metres out; the formats are in gmsh_*.cpp,
/// vtk_*.cpp.
///
/// Own readers, on purpose. Gmsh's library is GPL-2+, loads 91 shared libraries at each start, and its VTK reader drops
/// unreferenced nodes in silence, whereas a user must learn which they are. VTK is larger still. Neither bounds what a
/// damaged file makes it allocate nor names the line or byte at fault.
#include "mesh/reader/mesh_file.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <sstream>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "mesh/coincident_nodes.h"
#include "mesh/conformity.h"
#include "mesh/fill/fill_surface.h"
#include "mesh/mesh_checks.h"
#include "mesh/mesh_quality.h"
#include "mesh/nodes.h"
#include "mesh/orientation.h"
#include "tissue_contact/core/check.h"
#include "tissue_contact/core/read_file.h"
#include "tissue_contact/mesh/tet_mesh.h"

namespace tissue_contact {
namespace {

// Two million tetrahedra, the most a scene may have, take 100 MB as text. What is read from so many bytes is at most some
// ten times as large, physical groups aside, which have a bound of their own.
constexpr std::uintmax_t kMaximumFileBytes = std::uintmax_t{256} << 20U;

MeshFileContents readContents(const std::string& file, bool with_labels) {
  std::string bytes = readFile(file, "mesh file", kMaximumFileBytes);
  // A byte-order mark and blank lines before the first word are none of the format's, but editors leave them.
  if (bytes.rfind("\xEF\xBB\xBF", 0) == 0) bytes.erase(0, 3);
  const std::size_t begin = std::min(bytes.find_first_not_of(" \t\r\n"), bytes.size());
  const std::string_view text = std::string_view(bytes).substr(begin);
  const bool gmsh = text.substr(0, 1) == "$";
  const bool vtk = text.substr(0, 6) == "# vtk ";
  const bool xml = text.substr(0, 1) == "<";
  const bool surface = xml && text.substr(0, 4096).find("type=\"PolyData\"") != std::string_view::npos;
  const std::string start = excerpt(text.substr(0, text.find_first_of("\r\n")));
  MeshFileCursor in(file, std::move(bytes));
  in.seek(begin);
  if (gmsh) return readGmsh(in, with_labels);
  if (vtk) return readVtk(in, with_labels);
  if (in.atEnd()) in.fail("the file is empty; it must hold a Gmsh .msh or a legacy VTK mesh");
  in.fail(
      "the file starts with " + start +
      ", which is neither Gmsh .msh ('$MeshFormat' or '$NOD') nor legacy VTK ('# vtk DataFile Version')" +
      (xml ? "; XML is not read" : "") +
      (surface
           ? "; save this surface as .stl, for instance with ParaView, which make_scene.py fills"
           : "; convert it, for instance: meshio convert FILE organ.vtk (GiD's .msh it does not read: export another "
             "format there)"));
}

void requireVolumes(const MeshFileContents& contents, const std::string& file) {
  if (contents.other_volumes > 0) {
    throw std::invalid_argument("mesh file '" + file + "' holds " + std::to_string(contents.other_volumes) +
                                " polyhedra or other cells that are no tetrahedra, pyramids, prisms or hexahedra and "
                                "would be missing; split them into tetrahedra, for instance with ParaView's filter "
                                "Tetrahedralize");
  }
  if (!contents.volumes.empty()) return;
  throw std::invalid_argument("mesh file '" + file + "' holds no tetrahedra (" + std::to_string(contents.nodes.size()) +
                              " nodes, " + std::to_string(contents.other_elements) +
                              " elements of other kinds); mesh its volume, or save a closed surface as .stl (meshio "
                              "convert FILE organ.stl), which is filled");
}

void merge(const std::vector<int>& first, std::vector<ElementCorners>& elements) {
  for (ElementCorners& corners : elements) {
    for (int& node : corners) node = node < 0 ? node : first[static_cast<std::size_t>(node)];
  }
}

/// Or diagonal: between two corners of a volume that do not lie in one place; infinity where there are none. In the file's unit.
double shortestEdge(const MeshFileContents& contents) {
  double squared = std::numeric_limits<double>::infinity();
  for (const ElementCorners& corners : contents.volumes) {
    for (std::size_t i = 0; i < cornerCount(corners); ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        const double edge = (contents.nodes[static_cast<std::size_t>(corners[i])] -
                             contents.nodes[static_cast<std::size_t>(corners[j])])
                                .squaredNorm();
        if (edge > 0.0) squared = std::min(squared, edge);
      }
    }
  }
  return std::sqrt(squared);
}

/// @return the nodes that were merged with others, which nothing uses then.
std::vector<int> treatCoincidentNodes(const MeshDescription& description, MeshFileContents& contents) {
  if (description.coincident_nodes == CoincidentNodes::kKeep) return {};
  std::vector<bool> used(contents.nodes.size(), false);
  for (const ElementCorners& corners : contents.volumes) {
    for (std::size_t i = 0; i < cornerCount(corners); ++i) used[static_cast<std::size_t>(corners[i])] = true;
  }
  const std::vector<int> first = firstInPlace(contents.nodes, used, shortestEdge(contents));
  std::vector<int> merged;
  for (int i = 0; i < static_cast<int>(first.size()); ++i) {
    if (first[static_cast<std::size_t>(i)] != i) merged.push_back(i);
  }
  if (merged.empty()) return {};
  if (description.coincident_nodes == CoincidentNodes::kRefuse) {
    const int one = merged.front();
    const Vector3 place = contents.nodes[static_cast<std::size_t>(one)] * description.scale_m_per_unit;
    std::ostringstream message;
    message << "mesh file '" << description.file << "': nodes " << first[static_cast<std::size_t>(one)] << " and "
            << one << " (0-based, in file order) both lie at (" << place.transpose() << ") m, and " << merged.size() - 1
            << " more in the place of others: the elements there do not hang together; set `coincident_nodes: merge` "
               "for this mesh to join them, or `keep` where that is a cut";
    throw std::invalid_argument(message.str());
  }
  merge(first, contents.volumes);
  for (MeshFileContents::Group& group : contents.groups) merge(first, group.elements);
  return merged;
}

/// Before anything is made of more elements than any scene may have.
void requireSize(const MeshFileContents& contents, const std::string& file) {
  constexpr std::size_t kMostPerHexahedron = 6;
  std::size_t most = 0;
  for (const ElementCorners& corners : contents.volumes) {
    const std::size_t count = cornerCount(corners);  // a tetrahedron, or two, three or six of them
    most += count == 4 ? 1 : count < 8 ? count - 3 : kMostPerHexahedron;
  }
  if (most <= kMostElements) return;
  throw std::invalid_argument("mesh file '" + file + "' makes " + std::to_string(most) + " tetrahedra; at most " +
                              std::to_string(kMostElements) + " may be: mesh it coarser");
}

/// Of a volume that was split: its tetrahedra from `begin` on have volumes of one sign. Not those of a side that is bent too far, or of a corner
/// that lies on a side.
void requireConvex(const NodalVectors& positions, const std::vector<Tetrahedron>& tetrahedra, std::size_t begin,
                   std::size_t element, const std::string& file) {
  bool is_positive = true;
  bool is_negative = true;
  for (std::size_t i = begin; i < tetrahedra.size(); ++i) {
    const double volume = relativeVolume(positions, tetrahedra[i]);
    is_positive = is_positive && volume > kZeroVolume;
    is_negative = is_negative && volume < -kZeroVolume;
  }
  if (begin == tetrahedra.size() || is_positive || is_negative) return;
  throw std::invalid_argument(
      "mesh file '" + file + "': volume element " + std::to_string(element) +
      " (0-based, in file order), a hexahedron, prism or pyramid, is so far from convex that a "
      "part of it is flat or inverted when it is split from its nodes into tetrahedra; repair it, or mesh with "
      "tetrahedra, for instance with ParaView's filter Tetrahedralize");
}

/// The volumes as tetrahedra.
/// @param volume_of gets, per tetrahedron, which volume it is a part of. Data stay those of volumes: there may be any number.
std::vector<Tetrahedron> splitVolumes(const MeshFileContents& contents, const NodalVectors& positions,
                                      const std::string& file, std::vector<int>& volume_of) {
  std::vector<Tetrahedron> tetrahedra;
  tetrahedra.reserve(contents.volumes.size());
  volume_of.clear();
  for (std::size_t volume = 0; volume < contents.volumes.size(); ++volume) {
    const ElementCorners& corners = contents.volumes[volume];
    const std::size_t begin = tetrahedra.size();
    addTetrahedra(corners, tetrahedra);
    if (cornerCount(corners) != 4) requireConvex(positions, tetrahedra, begin, volume, file);
    volume_of.resize(tetrahedra.size(), static_cast<int>(volume));
  }
  if (tetrahedra.empty()) throw std::invalid_argument("mesh file '" + file + "': all of its volumes have collapsed");
  return tetrahedra;
}

MeshLabels::Group splitGroup(const MeshFileContents::Group& group) {
  MeshLabels::Group split{group.dimension, group.number, group.name, {}};
  std::vector<Tetrahedron> tetrahedra;
  std::vector<Triangle> triangles;
  for (const ElementCorners& corners : group.elements) {
    if (group.dimension == 3) {
      addTetrahedra(corners, tetrahedra);
    } else if (group.dimension == 2) {
      addTriangles(corners, triangles);
    } else {
      split.elements.push_back({corners[0], corners[1], -1, -1});
    }
  }
  for (const Triangle& t : triangles) split.elements.push_back({t[0], t[1], t[2], -1});
  split.elements.insert(split.elements.end(), tetrahedra.begin(), tetrahedra.end());
  return split;
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
  requireVolumes(contents, description.file);
  requireSize(contents, description.file);
  const std::vector<int> merged = treatCoincidentNodes(description, contents);
  TetMesh mesh{columnsOf(contents.nodes), {}};
  std::vector<int> volume_of;
  mesh.tetrahedra = splitVolumes(contents, mesh.positions, description.file, volume_of);
  if (labels != nullptr) {
    *labels = {mesh.positions * description.scale_m_per_unit, {}, std::move(contents.cell_data), std::move(volume_of)};
    for (const MeshFileContents::Group& group : contents.groups) labels->groups.push_back(splitGroup(group));
  }
  std::vector<int> needless = std::move(contents.between_corners);
  needless.insert(needless.end(), merged.begin(), merged.end());
  if (description.remove_unreferenced_nodes || !needless.empty()) {
    dropUnusedNodes(mesh.positions, mesh.tetrahedra, description.remove_unreferenced_nodes ? nullptr : &needless);
  }
  scale(description, mesh.positions);
  const std::size_t turned = turnTetrahedra(mesh, "mesh file '" + description.file + "'");
  const auto say = [&](std::size_t count, const std::string& what) {
    if (count == 0 || !preparation.say) return;
    preparation.say("mesh file '" + description.file + "': " + std::to_string(count) + " " + what);
  };
  const std::string of_all = "of " + std::to_string(mesh.tetrahedra.size()) + " tetrahedra ";
  const auto others = std::count_if(contents.volumes.begin(), contents.volumes.end(),
                                    [](const ElementCorners& corners) { return cornerCount(corners) != 4; });
  say(contents.higher_order, "of " + std::to_string(contents.volumes.size()) +
                                 " elements are of higher order; their corners are taken, with straight edges");
  say(static_cast<std::size_t>(others), "of " + std::to_string(contents.volumes.size()) +
                                            " elements are hexahedra, prisms or pyramids, and split into tetrahedra");
  say(merged.size(), "nodes that lay where others do are merged with them");
  say(turned, of_all + "are numbered the other way round, and turned");
  if (preparation.say && description.coincident_nodes != CoincidentNodes::kKeep) {
    const NearNodes near = findNearNodes(mesh);
    std::ostringstream where;
    if (near.count > 0) {
      const Vector3 one = mesh.positions.col(near.one);
      where << "nodes lie nearer to others than a hundredth of the edges there and are not joined with them, the first "
            << (mesh.positions.col(near.other) - one).norm() << " m away at (" << one.x() << ", " << one.y() << ", "
            << one.z()
            << ") m: the tissue is cut open there; if it is one, mesh it as one, or write coordinates that are equal, "
               "and set coincident_nodes: merge";
    }
    say(near.count, where.str());
  }
  const std::string flat = flatElementsText(mesh);
  if (!flat.empty() && preparation.say) preparation.say("mesh file '" + description.file + "': " + flat);
  const std::size_t parts = countParts(mesh);
  say(parts > 1 ? parts : 0, "parts that share no node: each is held only by what is fixed of it");
  const std::size_t by_faces = countPartsByFaces(mesh);
  say(by_faces > parts ? by_faces : 0,
      "parts that share no face, some of which hang on others by edges or nodes alone: they turn about these freely, "
      "as on hinges; "
      "mesh the body anew if it is one");
  return mesh;
}

}  // namespace tissue_contact
