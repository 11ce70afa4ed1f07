#include "contact/shape/shape_distance.h"

#include <algorithm>
#include <stdexcept>
#include <variant>

#include "contact/shape/field_distance.h"
#include "contact/shape/mesh_field.h"
#include "tissue_contact/contact/contact_detector.h"

namespace tissue_contact {
namespace {

struct HalfExtent {
  const TriangleMesh* mesh;

  double operator()(const SphereGeometry& sphere) const { return sphere.radius_m; }
  double operator()(const BoxGeometry& box) const { return 0.5 * box.size_m.minCoeff(); }
  double operator()(const CylinderGeometry& cylinder) const {
    return std::min(cylinder.radius_m, 0.5 * cylinder.length_m);
  }
  double operator()(const MeshGeometry& geometry) const {
    if (!mesh || mesh->vertices.cols() == 0) {
      throw std::invalid_argument("mesh shape '" + geometry.file + "' was not loaded");
    }
    return 0.5 * (mesh->vertices.rowwise().maxCoeff() - mesh->vertices.rowwise().minCoeff()).minCoeff();
  }
};

}  // namespace

void ShapeDistance::foremostCorners(const Vector3&, const Eigen::AlignedBox3d&,
                                    std::vector<ShapeCorner>& corners) const {
  corners.clear();
}

std::unique_ptr<ShapeDistance> ShapeDistances::make(const CollisionShape& shape) {
  if (const auto* sphere = std::get_if<SphereGeometry>(&shape.geometry)) return makeSphereDistance(sphere->radius_m);
  if (const auto* box = std::get_if<BoxGeometry>(&shape.geometry)) return makeBoxDistance(0.5 * box->size_m);
  if (const auto* cylinder = std::get_if<CylinderGeometry>(&shape.geometry)) {
    return makeCylinderDistance(cylinder->radius_m, 0.5 * cylinder->length_m);
  }
  return makeMesh(std::get<MeshGeometry>(shape.geometry), shape.mesh);
}

std::unique_ptr<ShapeDistance> ShapeDistances::makeMesh(const MeshGeometry& geometry,
                                                        const std::shared_ptr<const TriangleMesh>& mesh) {
  if (!mesh) throw std::invalid_argument("mesh shape '" + geometry.file + "' was not loaded");
  const Vector3& scale = geometry.scale;
  std::shared_ptr<const MeshField>& field = fields_[{geometry.file, scale.x(), scale.y(), scale.z()}];
  if (!field) field = prepareMeshField(*mesh, geometry.file, preparation_);
  return std::make_unique<FieldDistance>(field);
}

double smallestHalfExtent(const CollisionShape& shape) {
  return std::visit(HalfExtent{shape.mesh.get()}, shape.geometry);
}

}  // namespace tissue_contact
