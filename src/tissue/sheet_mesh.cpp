#include "tissue_contact/tissue/sheet_mesh.h"

#include <algorithm>
#include <cstdint>
#include <sstream>
#include <stdexcept>

#include "mesh_checks.h"
#include "tissue_contact/core/check.h"
#include "tissue_contact/instrument/collision_shape.h"
#include "triangle_edges.h"

namespace tissue_contact {
namespace {

// As for blocks: far beyond what can be stepped, and a bound on what a scene file can make us allocate.
constexpr std::int64_t kMaximumCells = 1'000'000;

// Relative to the square of the longest edge (an equilateral triangle has 0.433): below it the direction of the normal
// is rounding.
constexpr double kZeroArea = 1e-10;

/// Node i of n along an axis of the given length, symmetric to the last bit.
double gridCoordinate(int i, int n, double size) { return size * (0.5 * (2 * i - n) / n); }

void checkTriangle(const SheetMesh& mesh, std::size_t index, const std::string& source) {
  const Triangle& t = mesh.triangles[index];
  checkNodeIndices(t, index, mesh.positions.cols(), "triangle", source);
  double longest = 0.0;
  for (std::size_t k = 0; k < 3; ++k) {
    longest = std::max(longest, (mesh.positions.col(t[(k + 1) % 3]) - mesh.positions.col(t[k])).stableNorm());
  }
  // Lengths first, so that neither tiny nor huge units under- or overflow. NaN: all nodes in one place.
  const Vector3 a = (mesh.positions.col(t[1]) - mesh.positions.col(t[0])) / longest;
  const Vector3 b = (mesh.positions.col(t[2]) - mesh.positions.col(t[0])) / longest;
  if (0.5 * a.cross(b).norm() > kZeroArea) return;
  std::ostringstream message;
  message << indexed("triangle", index) << " (nodes " << t[0] << ", " << t[1] << ", " << t[2]
          << ") has no area (at most 1e-10 of its longest edge squared); remesh or remove it";
  refuseMesh(source, message.str());
}

void checkEdges(const std::vector<Triangle>& triangles, const std::string& source) {
  const std::vector<EdgeUse> uses = sortedEdges(triangles);
  for (std::size_t i = 0, end = 0; i < uses.size(); i = end) {
    for (end = i + 1; end < uses.size() && uses[end].nodes == uses[i].nodes;) ++end;
    if (end - i == 1) continue;
    const EdgeUse& first = uses[i];
    const EdgeUse& second = uses[i + 1];
    const std::string edge = "the edge of nodes " + std::to_string(first.nodes[0]) + " and " +
                             std::to_string(first.nodes[1]) + " belongs to ";
    const std::string both = indexed("triangles", first.triangle) + indexed(" and", second.triangle);
    if (end - i > 2) {
      refuseMesh(source, edge + std::to_string(end - i) + " triangles, among them " + both +
                             indexed(" and", uses[i + 2].triangle) +
                             "; at most 2 may share it: repair the mesh, or model the parts as tissues of their own");
    }
    if (triangles[first.triangle][first.edge] != triangles[second.triangle][second.edge]) continue;
    refuseMesh(source, edge + both +
                           ", which are wound against each other (their normals point to opposite sides); "
                           "swap two nodes of one, or recompute normals in the tool that made the mesh");
  }
}

}  // namespace

SheetMesh makeSheetMesh(const SheetDescription& sheet) {
  requirePositive("sheet size along x", sheet.size_m.x(), "m");
  requirePositive("sheet size along y", sheet.size_m.y(), "m");
  for (std::size_t axis = 0; axis < 2; ++axis) {
    if (sheet.cells[axis] < 1 || sheet.cells[axis] > kMaximumCells) {
      throwBadValue(axis == 0 ? "sheet cells along x" : "sheet cells along y", sheet.cells[axis], "",
                    "at least 1, and at most a million in all");
    }
  }
  const auto [nx, ny] = sheet.cells;
  const std::int64_t total = std::int64_t{nx} * ny;
  if (total > kMaximumCells) throwBadValue("sheet cells", static_cast<double>(total), "", "at most 1000000 in all");
  SheetMesh mesh;
  mesh.positions.resize(3, static_cast<Eigen::Index>(nx + 1) * (ny + 1));
  Eigen::Index node = 0;
  for (int j = 0; j <= ny; ++j) {
    for (int i = 0; i <= nx; ++i) {
      mesh.positions.col(node++) << gridCoordinate(i, nx, sheet.size_m.x()), gridCoordinate(j, ny, sheet.size_m.y()),
          0.0;
    }
  }
  mesh.triangles.reserve(static_cast<std::size_t>(2 * total));
  for (int j = 0; j < ny; ++j) {
    for (int i = 0; i < nx; ++i) {
      const int a = i + (nx + 1) * j;
      const int b = a + 1;
      const int c = a + nx + 1;
      const int d = c + 1;
      if ((i + j) % 2 == 0) {
        mesh.triangles.insert(mesh.triangles.end(), {{a, b, d}, {a, d, c}});
      } else {
        mesh.triangles.insert(mesh.triangles.end(), {{a, b, c}, {b, d, c}});
      }
    }
  }
  return mesh;
}

SheetMesh loadShellMesh(const ShellDescription& shell) {
  requirePositive("mesh file '" + shell.file + "': scale_m_per_unit", shell.scale_m_per_unit, "m");
  TriangleMesh loaded = loadTriangleMesh(shell.file, Vector3::Constant(shell.scale_m_per_unit));
  return {std::move(loaded.vertices), std::move(loaded.triangles)};
}

void checkSheetMesh(const SheetMesh& mesh, const std::string& source) {
  if (mesh.triangles.empty()) refuseMesh(source, "the mesh has no triangles; it must have at least one");
  checkFiniteNodes(mesh.positions, source);
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) checkTriangle(mesh, i, source);
  checkDuplicates(mesh.triangles, "triangle", source);
  checkEdges(mesh.triangles, source);
  checkReferences(mesh.triangles, mesh.positions.cols(), "triangle", "remove such nodes from the mesh", source);
}

double triangleArea(const NodalVectors& x, const Triangle& triangle) {
  const Vector3 a = x.col(triangle[1]) - x.col(triangle[0]);
  const Vector3 b = x.col(triangle[2]) - x.col(triangle[0]);
  return 0.5 * a.cross(b).norm();
}

}  // namespace tissue_contact
