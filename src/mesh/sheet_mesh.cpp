/// @file
/// Room `mesh`: sheets: generated, and what is asked of the mesh of a membrane.
#include <algorithm>
#include <cstdint>
#include <sstream>
#include <stdexcept>

#include "mesh/edge_table.h"
#include "mesh/mesh_checks.h"
#include "tissue_contact/core/check.h"
#include "tissue_contact/mesh/triangle_mesh.h"

namespace tissue_contact {
namespace {

constexpr std::int64_t kMaximumCells = kMostElements / 2;

// Relative to the square of the longest edge (an equilateral triangle has 0.433): below it the direction of the normal
// is rounding.
constexpr double kZeroArea = 1e-10;

/// Node i of n along an axis of the given length, symmetric to the last bit.
double gridCoordinate(int i, int n, double size) { return size * (0.5 * (2 * i - n) / n); }

void checkTriangle(const TriangleMesh& mesh, std::size_t index, const std::string& source) {
  const Triangle& t = mesh.triangles[index];
  checkNodeIndices(t, index, mesh.vertices.cols(), "triangle", source);
  double longest = 0.0;
  for (std::size_t k = 0; k < 3; ++k) {
    longest = std::max(longest, (mesh.vertices.col(t[(k + 1) % 3]) - mesh.vertices.col(t[k])).stableNorm());
  }
  // Lengths first, so that neither tiny nor huge units under- or overflow. NaN: all nodes in one place.
  const Vector3 a = (mesh.vertices.col(t[1]) - mesh.vertices.col(t[0])) / longest;
  const Vector3 b = (mesh.vertices.col(t[2]) - mesh.vertices.col(t[0])) / longest;
  if (0.5 * a.cross(b).norm() > kZeroArea) return;
  std::ostringstream message;
  message << indexed("triangle", index) << " (nodes " << t[0] << ", " << t[1] << ", " << t[2]
          << ") has no area (at most 1e-10 of its longest edge squared); remesh or remove it";
  refuseMesh(source, message.str());
}

void checkEdges(const std::vector<Triangle>& triangles, const std::string& source) {
  const EdgeTable table(triangles);
  for (const EdgeTable::Edge& edge : table) {
    const EdgeTable::Uses uses = table.usesOf(edge);
    if (uses.size() == 1) continue;
    std::string which = "the edge of nodes " + std::to_string(edge.nodes[0]);
    which.append(" and ").append(std::to_string(edge.nodes[1])).append(" belongs to ");
    const std::string both = indexed("triangles", uses[0].triangle) + indexed(" and", uses[1].triangle);
    if (uses.size() > 2) {
      which.append(std::to_string(uses.size())).append(" triangles, among them ").append(both);
      which.append(indexed(" and", uses[2].triangle));
      refuseMesh(source,
                 which + "; at most 2 may share it: repair the mesh, or model the parts as tissues of their own");
    }
    if (uses[0].forward != uses[1].forward) continue;
    refuseMesh(source, which + both +
                           ", which are wound against each other (their normals point to opposite sides); "
                           "swap two nodes of one, or recompute normals in the tool that made the mesh");
  }
}

}  // namespace

TriangleMesh makeSheetMesh(const SheetDescription& sheet) {
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
  TriangleMesh mesh;
  mesh.vertices.resize(3, static_cast<Eigen::Index>(nx + 1) * (ny + 1));
  Eigen::Index node = 0;
  for (int j = 0; j <= ny; ++j) {
    for (int i = 0; i <= nx; ++i) {
      mesh.vertices.col(node++) << gridCoordinate(i, nx, sheet.size_m.x()), gridCoordinate(j, ny, sheet.size_m.y()),
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

TriangleMesh loadShellMesh(const ShellDescription& shell) {
  requirePositive("mesh file '" + shell.file + "': scale_m_per_unit", shell.scale_m_per_unit, "m");
  return loadTriangleMesh(shell.file, Vector3::Constant(shell.scale_m_per_unit));
}

void checkSheetMesh(const TriangleMesh& mesh, const std::string& source) {
  if (mesh.triangles.empty()) refuseMesh(source, "the mesh has no triangles; it must have at least one");
  checkFiniteNodes(mesh.vertices, source);
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i) checkTriangle(mesh, i, source);
  checkDuplicates(mesh.triangles, "triangle", source);
  checkEdges(mesh.triangles, source);
  checkReferences(mesh.triangles, mesh.vertices.cols(), "triangle", "remove such nodes from the mesh", source);
}

double triangleArea(const NodalVectors& x, const Triangle& triangle) {
  const Vector3 a = x.col(triangle[1]) - x.col(triangle[0]);
  const Vector3 b = x.col(triangle[2]) - x.col(triangle[0]);
  return 0.5 * a.cross(b).norm();
}

}  // namespace tissue_contact
