#include "tissue_contact/instrument/collision_shape.h"

#include <filesystem>
#include <stdexcept>
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
  }
  return shape;
}

}  // namespace tissue_contact
