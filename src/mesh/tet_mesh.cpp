/// @file
/// Room `mesh`: what is asked of any tetrahedral mesh: checks, volume, boundary surface.
#include "tissue_contact/mesh/tet_mesh.h"

#include <algorithm>
#include <array>
#include <sstream>
#include <stdexcept>
#include <tuple>

#include "mesh/face_table.h"
#include "mesh/mesh_checks.h"

namespace tissue_contact {
namespace {

void checkElement(const TetMesh& mesh, std::size_t index, const std::string& source) {
  const Tetrahedron& tet = mesh.tetrahedra[index];
  checkNodeIndices(tet, index, mesh.positions.cols(), "tetrahedron", source);
  const double volume = relativeVolume(mesh.positions, tet);
  if (volume > kZeroVolume) return;
  std::ostringstream message;
  message << indexed("tetrahedron", index) << " (nodes " << tet[0] << ", " << tet[1] << ", " << tet[2] << ", "
          << tet[3];
  // NaN (all four nodes in one place) counts as zero volume.
  if (volume < -kZeroVolume) {
    message << ") is inverted, of volume " << signedVolume(mesh.positions, tet)
            << " m^3; it must be positive; the mesh is folded there: repair it";
  } else {
    message << ") has no volume (it is flat to 1e-12 of its longest edge cubed); remesh or remove it";
  }
  refuseMesh(source, message.str());
}

/// Faces opposite to nodes 0 to 3, counter-clockwise seen from outside a tetrahedron of positive volume.
constexpr std::array<std::array<std::size_t, 3>, 4> kOutwardFaces = {{{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}}};

}  // namespace

Triangle outwardFace(const Tetrahedron& tet, std::size_t opposite) {
  const auto& local = kOutwardFaces[opposite];
  return {tet[local[0]], tet[local[1]], tet[local[2]]};
}

double signedVolume(const NodalVectors& x, const Tetrahedron& tet) {
  const Vector3 a = x.col(tet[0]);
  const Vector3 b = x.col(tet[1]) - a;
  const Vector3 c = x.col(tet[2]) - a;
  const Vector3 d = x.col(tet[3]) - a;
  return b.cross(c).dot(d) / 6.0;
}

void checkTetMesh(const TetMesh& mesh, const std::string& source) {
  if (mesh.tetrahedra.empty()) refuseMesh(source, "the mesh has no tetrahedra; it must have at least one");
  checkFiniteNodes(mesh.positions, source);
  for (std::size_t i = 0; i < mesh.tetrahedra.size(); ++i) checkElement(mesh, i, source);
  checkDuplicates(mesh.tetrahedra, "tetrahedron", source);
  checkReferences(mesh.tetrahedra, mesh.positions.cols(), "tetrahedron",
                  "set `remove_unreferenced_nodes: true` for this mesh, or repair it", source);
}

std::vector<FaceUse> sortedFaces(const std::vector<Tetrahedron>& tetrahedra) {
  std::vector<FaceUse> faces;
  faces.reserve(4 * tetrahedra.size());
  for (std::size_t e = 0; e < tetrahedra.size(); ++e) {
    for (std::size_t i = 0; i < 4; ++i) {
      faces.push_back({outwardFace(tetrahedra[e], i), e, i});
      std::sort(faces.back().nodes.begin(), faces.back().nodes.end());
    }
  }
  std::sort(faces.begin(), faces.end(), [](const FaceUse& a, const FaceUse& b) {
    return std::tie(a.nodes, a.tetrahedron, a.opposite) < std::tie(b.nodes, b.tetrahedron, b.opposite);
  });
  return faces;
}

std::vector<OuterFace> outerFaces(const std::vector<Tetrahedron>& tetrahedra) {
  const std::vector<FaceUse> faces = sortedFaces(tetrahedra);
  std::vector<OuterFace> outer;
  for (std::size_t i = 0, end = 0; i < faces.size(); i = end) {
    for (end = i + 1; end < faces.size() && faces[end].nodes == faces[i].nodes;) ++end;
    if (end - i > 2) {
      const Triangle& nodes = faces[i].nodes;
      throw std::invalid_argument(
          "the face of nodes " + std::to_string(nodes[0]) + ", " + std::to_string(nodes[1]) + ", " +
          std::to_string(nodes[2]) + " belongs to " + std::to_string(end - i) + " tetrahedra, among them " +
          std::to_string(faces[i].tetrahedron) + ", " + std::to_string(faces[i + 1].tetrahedron) + " and " +
          std::to_string(faces[i + 2].tetrahedron) + "; at most 2 may share it: repair the mesh");
    }
    if (end - i == 1) outer.push_back({faces[i].tetrahedron, faces[i].opposite});
  }
  std::sort(outer.begin(), outer.end(), [](const OuterFace& a, const OuterFace& b) {
    return std::tie(a.tetrahedron, a.opposite) < std::tie(b.tetrahedron, b.opposite);
  });
  return outer;
}

std::vector<Triangle> boundaryTriangles(const std::vector<Tetrahedron>& tetrahedra) {
  std::vector<Triangle> triangles;
  for (const OuterFace& face : outerFaces(tetrahedra)) {
    triangles.push_back(outwardFace(tetrahedra[face.tetrahedron], face.opposite));
  }
  return triangles;
}

}  // namespace tissue_contact
