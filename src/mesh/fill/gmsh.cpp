#include "mesh/fill/gmsh.h"

#include <algorithm>
#include <fstream>
#include <sstream>
#include <stdexcept>
#include <utility>

#include "mesh/fill/run_program.h"
#include "tissue_contact/core/read_file.h"
#include "tissue_contact/core/text.h"
#include "tissue_contact/mesh/gmsh_version.h"

namespace tissue_contact {
namespace {

// Two million tetrahedra, the most a scene may have, take it some ten seconds and 1 GB.
constexpr ProgramLimits kLimits = {300, std::size_t{8} << 30U};
constexpr std::uintmax_t kMostMeshBytes = std::uintmax_t{256} << 20U;

// Edges sharper than this are kept where that gives sound elements: those of a cast phantom, not those of a scan's noise.
constexpr double kEdgeAngle = 40.0;
constexpr double kNoEdges = 180.0;
constexpr double kSoundAngle = 5.0;  // degrees; gmsh keeps some ten where nothing is in its way

constexpr double kGrowth = 0.5;  // length that cells gain per length away from the surface, as refinement does it

[[noreturn]] void refuseMissing() {
  throw std::invalid_argument(
      "filling a surface with tetrahedra takes the program gmsh, which is not installed; install it (apt-get install "
      "gmsh), "
      "or fill the surface elsewhere and name the .msh or .vtk file");
}

/// gmsh 4.4, of Ubuntu 20.04, does not know what the script asks for, and crashes where it is told so in its own words.
void refuseOld(const std::string& version) {
  std::istringstream numbers(version);
  int major = 0;
  int minor = 0;
  char dot = 0;
  if (!(numbers >> major >> dot >> minor) || std::make_pair(major, minor) >= std::make_pair(4, 7)) return;
  throw std::invalid_argument("gmsh " + version +
                              " is too old to fill a surface with tetrahedra; 4.7 or later does (pip3 install gmsh, or "
                              "gmsh.info), or fill the surface elsewhere and name the .msh or .vtk file");
}

/// The same surface, each triangle in three around its centroid.
TriangleMesh inThirds(const TriangleMesh& surface) {
  TriangleMesh parts;
  const Eigen::Index corners = surface.vertices.cols();
  parts.vertices.resize(3, corners + static_cast<Eigen::Index>(surface.triangles.size()));
  parts.vertices.leftCols(corners) = surface.vertices;
  for (const auto& [a, b, c] : surface.triangles) {
    const int middle = static_cast<int>(corners) + static_cast<int>(parts.triangles.size()) / 3;
    parts.vertices.col(middle) = (surface.vertices.col(a) + surface.vertices.col(b) + surface.vertices.col(c)) / 3.0;
    for (const auto& [p, q] : {std::pair(a, b), std::pair(b, c), std::pair(c, a)})
      parts.triangles.push_back({p, q, middle});
  }
  return parts;
}

/// In units of a cell: gmsh has absolute tolerances.
void writeSurface(const TriangleMesh& surface, double unit_m, const std::string& path) {
  std::ofstream out(path);
  out.precision(17);
  out << "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$Nodes\n" << surface.vertices.cols() << "\n";
  for (Eigen::Index i = 0; i < surface.vertices.cols(); ++i) {
    out << i + 1 << " " << (surface.vertices.col(i) / unit_m).transpose() << "\n";
  }
  out << "$EndNodes\n$Elements\n" << surface.triangles.size() << "\n";
  std::size_t tag = 0;
  for (const Triangle& t : surface.triangles) {
    out << ++tag << " 2 2 0 1 " << t[0] + 1 << " " << t[1] + 1 << " " << t[2] + 1 << "\n";
  }
  out << "$EndElements\n";
  if (!out.flush()) throw std::runtime_error("cannot write " + path);
}

/// What gmsh prints as errors, without its frame.
std::string errorsIn(const std::string& output) {
  constexpr std::size_t kMostText = 200;
  std::istringstream lines(output);
  std::string found;
  for (std::string line; std::getline(lines, line) && found.size() < kMostText;) {
    const std::size_t start = line.find("Error   : ");
    if (start == std::string::npos || line.find("-----") != std::string::npos) continue;
    if (line.find("summary") != std::string::npos) break;
    found += (found.empty() ? "" : "; ") + line.substr(start + 10);
  }
  return printable(found, kMostText);
}

GmshResult attempt(const TriangleMesh& surface, const FillOptions& options, double edge_angle) {
  const ScratchFolder folder;
  constexpr std::size_t kTetrahedron = 4;  // gmsh 4.8 never ends cutting the surface of one into patches
  const std::string path = folder.path("surface.msh");
  if (surface.triangles.size() == kTetrahedron) {
    writeSurface(inThirds(surface), options.cell_m, path);
  } else {
    writeSurface(surface, options.cell_m, path);
  }
  std::ofstream(folder.path("fill.geo")) << gmshScript(options, edge_angle);
  const ProgramEnd end =
      runProgram({"gmsh", "-3", "fill.geo", "-o", "filled.msh", "-nt", "1", "-v", "3"}, folder.path(), kLimits);
  if (!end.found) refuseMissing();
  GmshResult result;
  result.complaint = errorsIn(end.output);
  result.timed_out = end.timed_out;
  if (end.timed_out) result.complaint = "it takes longer than " + std::to_string(kLimits.seconds) + " s";
  if (end.timed_out || !result.complaint.empty()) return result;
  try {
    MeshDescription made;
    made.file = folder.path("filled.msh");
    result.mesh = loadTetMesh(made);
    checkTetMesh(result.mesh, "the mesh that gmsh made");
    result.quality = qualityOf(result.mesh);
    result.file = readFile(made.file, "mesh file", kMostMeshBytes);
  } catch (const std::invalid_argument& error) {
    result.complaint = end.well ? error.what() : "it ended without a mesh";
  }
  return result;
}

}  // namespace

std::string gmshVersion() {
  const ScratchFolder folder;
  const ProgramEnd end = runProgram({"gmsh", "--version"}, folder.path(), kLimits);
  if (!end.found) refuseMissing();
  std::string version = printable(end.output.substr(0, end.output.find('\n')));
  if (!end.well || version.empty() || version.size() > 64) {
    throw std::invalid_argument("the program gmsh does not run: `gmsh --version` says " + inQuotes(version));
  }
  refuseOld(version);
  return version;
}

std::string gmshScript(const FillOptions& options, double edge_angle) {
  const double inside = options.inside_cell_m / options.cell_m;
  std::ostringstream script;
  script.precision(17);
  script << "Merge \"surface.msh\";\n"
         << "ClassifySurfaces{" << edge_angle << " * Pi / 180, 1, 1, Pi};\n"
         << "CreateGeometry;\n"
         << "Surface Loop(1) = Surface{:};\nVolume(1) = {1};\nPhysical Volume(\"tissue\") = {1};\n"
         << "Mesh.MeshSizeFromPoints = 0;\nMesh.MeshSizeExtendFromBoundary = 0;\n"
         << "Mesh.MeshSizeMin = 1;\nMesh.MeshSizeMax = " << inside << ";\n";
  if (inside > 1.0) {
    script << "Field[1] = Distance;\nField[1].SurfacesList = {Surface{:}};\n"
           << "Field[2] = Threshold;\nField[2].InField = 1;\nField[2].SizeMin = 1;\nField[2].SizeMax = " << inside
           << ";\nField[2].DistMin = 1;\nField[2].DistMax = " << 1.0 + (inside - 1.0) / kGrowth
           << ";\nBackground Field = 2;\n";
  }
  script << "Mesh.Algorithm = 6;\nMesh.Algorithm3D = 10;\nMesh.RandomSeed = 1;\n"
         << "Mesh.ScalingFactor = " << options.cell_m << ";\nMesh.MshFileVersion = 2.2;\nMesh.Binary = 0;\n";
  return script.str();
}

GmshResult fillWithGmsh(const TriangleMesh& surface, const FillOptions& options) {
  GmshResult sharp = attempt(surface, options, kEdgeAngle);
  if (!sharp.file.empty() && sharp.quality.smallest_angle >= kSoundAngle) return sharp;
  if (sharp.timed_out) return sharp;  // the other way takes as long
  GmshResult smooth = attempt(surface, options, kNoEdges);
  const bool is_smooth_better =
      sharp.file.empty() || (!smooth.file.empty() && smooth.quality.smallest_angle > sharp.quality.smallest_angle);
  return is_smooth_better ? smooth : sharp;
}

}  // namespace tissue_contact
