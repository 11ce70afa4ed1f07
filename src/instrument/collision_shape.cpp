#include "tissue_contact/instrument/collision_shape.h"

#include <algorithm>
#include <filesystem>
#include <set>
#include <stdexcept>
#include <utility>
#include <variant>

#include "tissue_contact/core/check.h"

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

void check(const MeshGeometry& mesh) {
  if (std::filesystem::path(mesh.file).is_absolute()) return;
  throw std::invalid_argument(
      "mesh '" + mesh.file +
      "' was not found: its ROS package is unknown, its scheme is not package:// or file://, or "
      "it is a relative path in a URDF that is not a file");
}

/// Contact needs to know which side is inside. Meshes as they come have small holes; an open sheet is mostly border.
void checkSolid(const TriangleMesh& mesh, const std::string& file) {
  constexpr double kMostBorder = 0.2;  // share of triangle sides without a partner
  std::set<std::pair<int, int>> sides;
  for (const Triangle& t : mesh.triangles) {
    for (int k = 0; k < 3; ++k) sides.insert({t[k], t[(k + 1) % 3]});
  }
  const auto open = std::count_if(sides.begin(), sides.end(), [&](const std::pair<int, int>& side) {
    return sides.count({side.second, side.first}) == 0;
  });
  if (static_cast<double>(open) <= kMostBorder * static_cast<double>(sides.size())) return;
  throw std::invalid_argument("mesh '" + file + "' is an open sheet: " + std::to_string(open) + " of its " +
                              std::to_string(sides.size()) +
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
