#include "tissue_contact/instrument/collision_shape.h"

#include <array>
#include <filesystem>
#include <stdexcept>
#include <utility>
#include <variant>

#include "mesh/edge_table.h"
#include "tissue_contact/core/check.h"
#include "tissue_contact/core/resolve_path.h"
#include "tissue_contact/instrument/instrument_description.h"
#include "tissue_contact/mesh/triangle_mesh.h"

namespace tissue_contact {
namespace {

void check(const SphereGeometry& sphere) { requirePositive("sphere radius", sphere.radius_m, "m"); }

void check(const BoxGeometry& box) {
  for (int i = 0; i < 3; ++i) requirePositive("box size " + std::string(1, "xyz"[i]), box.size_m[i], "m");
}

void check(const CylinderGeometry& cylinder) {
  requirePositive("cylinder radius", cylinder.radius_m, "m");
  requirePositive("cylinder length", cylinder.length_m, "m");
}

/// A path that is not absolute is one that could not be resolved when the URDF was read (meshPath() in parse_urdf.cpp).
void check(const MeshGeometry& mesh) {
  if (std::filesystem::path(mesh.file).is_absolute()) return;
  resolvePath(mesh.file, "", nullptr);  // tells what is wrong with a URI
  throw std::invalid_argument("mesh '" + mesh.file +
                              "' was not found: it is relative, and the URDF is the text of a parameter, in no folder; "
                              "give the URDF's file as urdf in the scene, or package:// paths in the URDF");
}

/// Contact needs to know which side is inside. Meshes as they come have small holes; an open sheet is mostly border.
void checkSolid(const TriangleMesh& mesh, const std::string& file) {
  constexpr double kMostBorder = 0.2;  // share of triangle sides without a partner
  const EdgeTable table(mesh.triangles);
  int sides = 0;  // each way along an edge counts once, however many triangles run it
  int open = 0;
  for (const EdgeTable::Edge& edge : table) {
    std::array<bool, 2> runs = {false, false};
    for (const EdgeUse& use : table.usesOf(edge)) runs[use.forward ? 0 : 1] = true;
    sides += runs[0] && runs[1] ? 2 : 1;
    open += runs[0] && runs[1] ? 0 : 1;
  }
  if (open <= kMostBorder * sides) return;
  throw std::invalid_argument("mesh '" + file + "' is an open sheet: " + std::to_string(open) + " of its " +
                              std::to_string(sides) +
                              " triangle sides have no neighbour; a tool that touches tissue must be a closed solid");
}

void checkPose(const Pose& X) {
  constexpr double kTolerance = 1e-6;  // dimensionless; poses read from text are not exact rotations
  if (!X.matrix().allFinite()) throw std::invalid_argument("shape has an origin that is not finite");
  const Matrix3 R = X.linear();
  if (!(R.transpose() * R).isIdentity(kTolerance) || !(R.determinant() > 0.0)) {
    throw std::invalid_argument("shape has an origin whose rotation is not a rotation matrix");
  }
}

}  // namespace

CollisionShape makeCollisionShape(const ShapeDescription& description) {
  checkPose(description.X_LS);
  std::visit([](const auto& geometry) { check(geometry); }, description.geometry);
  CollisionShape shape;
  shape.geometry = description.geometry;
  shape.X_LS = description.X_LS;
  if (const auto* mesh = std::get_if<MeshGeometry>(&description.geometry)) {
    shape.mesh = std::make_shared<const TriangleMesh>(loadTriangleMesh(mesh->file, mesh->scale));
    checkSolid(*shape.mesh, mesh->file);
  }
  return shape;
}

}  // namespace tissue_contact
