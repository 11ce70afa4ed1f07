#include "mesh/fill/fill_surface.h"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <limits>
#include <set>
#include <sstream>
#include <stdexcept>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "mesh/fill/closed_surface.h"
#include "mesh/fill/crossing_triangles.h"
#include "mesh/fill/gmsh.h"
#include "mesh/reader/assimp_reader.h"
#include "mesh/reader/flat_triangles.h"
#include "mesh/reader/mesh_cleanup.h"
#include "mesh/reader/mesh_file.h"
#include "mesh/surface/triangle_tree.h"
#include "tissue_contact/core/cache_folder.h"
#include "tissue_contact/core/check.h"
#include "tissue_contact/core/read_file.h"
#include "tissue_contact/core/text.h"
#include "tissue_contact/mesh/gmsh_version.h"
#include "tissue_contact/mesh/tet_mesh.h"

namespace tissue_contact {
namespace {

constexpr std::uint64_t kRecipe = 4;          // raise it when what is done to a surface changes
constexpr double kTetrahedraPerVolume = 4.5;  // of a cell's edge cubed, as gmsh fills organs
constexpr double kFewestCells = 3.0;          // across the longest side
constexpr double kLongOrgan = 2.0;            // m
constexpr double kMostVolumeError = 0.2;
constexpr std::string_view kNotes = "$Comments\nfilled by tissue_contact\n";
constexpr std::string_view kEnd = "$EndComments\n";

std::string sourceOf(const MeshDescription& description) { return "mesh file '" + description.file + "'"; }

std::string roundedText(double value, int digits = 2) {
  std::ostringstream out;
  out.precision(digits);
  out << value;
  return out.str();
}

FillOptions optionsOf(const MeshDescription& description) {
  return {description.cell_size_m, std::max(description.cell_size_m, description.cell_size_inside_m)};
}

std::string keyOf(const MeshDescription& description, const std::string& version) {
  ContentKey key;
  const std::string bytes = readFile(description.file, "mesh file", kMaxSurfaceBytes);
  const double numbers[] = {static_cast<double>(kRecipe), description.scale_m_per_unit, description.cell_size_m,
                            description.cell_size_inside_m};
  key.add(numbers, sizeof numbers);
  const std::string script = gmshScript(optionsOf(description), 0.0) + version;
  key.add(script.data(), script.size());
  key.add(bytes.data(), bytes.size());
  return key.digits();
}

std::string checksum(std::string_view content) {
  ContentKey key;
  key.add(content.data(), content.size());
  return key.digits();
}

/// The mesh file with what was said about it behind it, as a comment that readers of .msh skip.
std::string withNotes(std::string content, const std::vector<std::string>& notes) {
  content += kNotes;
  for (const std::string& note : notes) content += note + "\n";
  const std::string sum = checksum(content);
  return content + sum + "\n" + std::string(kEnd);
}

/// The notes, where the content is whole.
bool readNotes(const std::string& content, std::vector<std::string>& notes) {
  const std::size_t start = content.rfind(kNotes);
  const std::size_t tail = ContentKey::kDigits + 1 + kEnd.size();
  if (start == std::string::npos || content.size() < start + kNotes.size() + tail) return false;
  const std::string whole = content.substr(0, content.size() - tail);
  if (content.substr(whole.size()) != checksum(whole) + "\n" + std::string(kEnd)) return false;
  std::istringstream lines(whole.substr(start + kNotes.size()));
  for (std::string line; std::getline(lines, line);) notes.push_back(line);
  return true;
}

void tell(const MeshDescription& description, const std::vector<std::string>& notes,
          const MeshPreparation& preparation) {
  if (!preparation.say) return;
  for (const std::string& note : notes) preparation.say(sourceOf(description) + ": " + note);
}

/// @throws when the cells do not fit the size of the surface: one of the two has another unit than the scene says.
void requireFittingCells(const ClosedSurface& surface, const MeshDescription& description) {
  const Vector3 size = surface.mesh.vertices.rowwise().maxCoeff() - surface.mesh.vertices.rowwise().minCoeff();
  const double cell = description.cell_size_m;
  const std::string sizes = sourceOf(description) + ": with scale_m_per_unit " +
                            roundedText(description.scale_m_per_unit, 3) + " it is " + roundedText(size.x(), 3) +
                            " x " + roundedText(size.y(), 3) + " x " + roundedText(size.z(), 3) + " m";
  if (size.maxCoeff() < kFewestCells * cell) {
    throw std::invalid_argument(
        sizes + ", fewer than three cells of cell_size_m " + roundedText(cell, 3) +
        " m; give a smaller cell_size_m, or the scale_m_per_unit of its unit (1 for metres, 0.001 for "
        "millimetres)");
  }
  const double count = kTetrahedraPerVolume * surface.volume / std::pow(optionsOf(description).inside_cell_m, 3);
  if (count <= static_cast<double>(kMostElements)) return;
  throw std::invalid_argument(sizes + ", which takes some " + roundedText(count) + " tetrahedra of cell_size_m " +
                              roundedText(cell, 3) + " m, more than " + std::to_string(kMostElements) +
                              (size.maxCoeff() > kLongOrgan ? "; if it is in millimetres, give scale_m_per_unit: 0.001"
                                                            : "; give a larger cell_size_m"));
}

[[noreturn]] void refuseFilling(const MeshDescription& description, const Crossings& crossings,
                                const std::string& complaint) {
  std::ostringstream message;
  message.precision(3);
  message << sourceOf(description) << ": it cannot be filled";
  if (crossings.count > 0) {
    message << ": " << crossingText(crossings);
  } else {
    message << " with cells of cell_size_m " << description.cell_size_m
            << " m; where it is thinner than a cell, a smaller one helps, and sometimes slightly other ones do; else "
               "mesh the surface anew (MeshLab: Isotropic Explicit Remeshing), or fill it by hand and name the .msh";
  }
  message << (complaint.empty() ? "" : " (gmsh: " + complaint + ")");
  throw std::invalid_argument(message.str());
}

ClosedSurface readSurface(const MeshDescription& description) {
  const std::string source = sourceOf(description);
  const TriangleSoup soup = readTriangleSoup(description.file);
  TriangleMesh mesh = mergeVertices(soup.vertices, soup.triangles);
  if (mesh.triangles.empty()) throw std::invalid_argument(source + " has no triangles with an area");
  absorbFlatTriangles(mesh);  // gmsh finds no plane of them
  mesh.vertices *= description.scale_m_per_unit;
  if (!mesh.vertices.allFinite()) {
    throw std::invalid_argument(source + " has vertices that are not finite after scaling; reduce scale_m_per_unit");
  }
  return closeSurface(std::move(mesh), description.cell_size_m, source);
}

/// Where a surface is farther from the mesh that fills it than a cell: parts that are thinner than cells can be left out though hardly any volume is.
struct Missing {
  double farthest = 0.0;  ///< of its vertices from the mesh's surface, m
  Vector3 p = Vector3::Zero();
  double share = 0.0;  ///< of its vertices, farther than a cell
};

Missing findMissing(const TriangleMesh& surface, const TetMesh& mesh, double cell) {
  const TriangleTree tree(mesh.positions, boundaryTriangles(mesh.tetrahedra));
  std::set<int> vertices;
  for (const Triangle& triangle : surface.triangles) vertices.insert(triangle.begin(), triangle.end());
  Missing missing;
  for (const int vertex : vertices) {
    const Vector3 p = surface.vertices.col(vertex);
    const double distance = std::sqrt(tree.squaredDistance(p, std::numeric_limits<double>::infinity()));
    if (distance > cell) missing.share += 1.0 / static_cast<double>(vertices.size());
    if (distance > missing.farthest) missing = {distance, p, missing.share};
  }
  return missing;
}

struct Filled {
  GmshResult made;
  std::vector<std::string> notes;
};

Filled fill(const MeshDescription& description, const std::string& version) {
  const ClosedSurface surface = readSurface(description);
  requireFittingCells(surface, description);
  Filled filled{fillWithGmsh(surface.mesh, optionsOf(description)), surface.notes};
  const Crossings crossings = findCrossings(surface.mesh);
  if (filled.made.file.empty()) refuseFilling(description, crossings, filled.made.complaint);
  const double share = filled.made.quality.volume / surface.volume;
  if (!(std::abs(share - 1.0) <= kMostVolumeError)) {
    refuseFilling(description, crossings,
                  "its tetrahedra have " + roundedText(100.0 * share, 3) + " % of the surface's volume");
  }
  if (crossings.count > 0) {
    filled.notes.push_back("it passes through itself in " + std::to_string(crossings.count) +
                           " places smaller than cells, which are gone in the mesh");
  }
  filled.notes.push_back("filled with " + std::to_string(filled.made.mesh.tetrahedra.size()) + " tetrahedra on " +
                         std::to_string(filled.made.mesh.positions.cols()) + " nodes, cells of " +
                         roundedText(1e3 * description.cell_size_m, 3) + " mm; smallest angle between faces " +
                         roundedText(filled.made.quality.smallest_angle) + " degrees, volume " +
                         roundedText(100.0 * share, 3) + " % of the surface's; by gmsh " + version);
  if (const std::string flat = flatElementsText(filled.made.mesh); !flat.empty()) filled.notes.push_back(flat);
  const Missing missing = findMissing(surface.mesh, filled.made.mesh, description.cell_size_m);
  if (missing.share > 0.0) {
    filled.notes.push_back(roundedText(100.0 * missing.share) +
                           " % of the surface's vertices are farther than a cell from that mesh, most " +
                           roundedText(1e3 * missing.farthest) + " mm, at (" + roundedText(missing.p.x(), 3) + ", " +
                           roundedText(missing.p.y(), 3) + ", " + roundedText(missing.p.z(), 3) +
                           ") m: what is thinner than cells" +
                           std::string(crossings.count > 0 ? ", or cut off where it passes through itself," : "") +
                           " is not in it; a smaller cell_size_m keeps more of it");
  }
  return filled;
}

/// From the cache; false where there is none, or it is damaged.
bool takeKept(const CacheFolder& cache, const std::string& key, const MeshDescription& description, TetMesh& mesh,
              std::vector<std::string>& notes) {
  const std::string content = cache.read(key);
  if (!readNotes(content, notes)) return false;
  try {
    MeshDescription kept;
    kept.file = cache.path(key);
    mesh = loadTetMesh(kept);
    checkTetMesh(mesh, sourceOf(description));
  } catch (const std::invalid_argument&) {
    return false;  // it has changed between the two readings
  }
  return true;
}

}  // namespace

TetMesh fillSurface(const MeshDescription& description, const MeshPreparation& preparation) {
  requirePositive("scale_m_per_unit of " + sourceOf(description), description.scale_m_per_unit, "m");
  requirePositive("cell_size_m of " + sourceOf(description), description.cell_size_m, "m");
  const std::string version = gmshVersion();
  const std::string key = keyOf(description, version);
  const std::string& folder = preparation.cache_directory;
  const CacheFolder cache(folder.empty() ? "" : folder + "/meshes", ".msh");
  TetMesh mesh;
  std::vector<std::string> notes;
  if (takeKept(cache, key, description, mesh, notes)) {
    tell(description, notes, preparation);
    tell(description, {"that mesh was kept as " + cache.path(key)}, preparation);
    return mesh;
  }
  tell(description, {"gmsh fills it, which takes some seconds as a rule, and up to ten minutes"}, preparation);
  Filled filled = fill(description, version);
  if (keyOf(description, version) != key) {
    throw std::invalid_argument(sourceOf(description) +
                                " was written to while it was filled; start again once that is done");
  }
  tell(description, filled.notes, preparation);
  const std::string trouble = cache.write(key, {withNotes(std::move(filled.made.file), filled.notes)});
  if (!trouble.empty()) {
    tell(description, {"filled again at every start: " + trouble}, preparation);
  } else if (!folder.empty()) {
    tell(description, {"that mesh is kept as " + cache.path(key)}, preparation);
  }
  return std::move(filled.made.mesh);
}

}  // namespace tissue_contact
