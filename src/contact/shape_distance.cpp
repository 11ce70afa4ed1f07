#include "contact/shape_distance.h"

#include <algorithm>
#include <stdexcept>

#include "tissue_contact/contact/contact_detector.h"

namespace tissue_contact {
namespace {

struct MakeDistance {
  const TriangleMesh* mesh;

  std::unique_ptr<ShapeDistance> operator()(const SphereGeometry& sphere) const {
    return makeSphereDistance(sphere.radius_m);
  }
  std::unique_ptr<ShapeDistance> operator()(const BoxGeometry& box) const { return makeBoxDistance(0.5 * box.size_m); }
  std::unique_ptr<ShapeDistance> operator()(const CylinderGeometry& cylinder) const {
    return makeCylinderDistance(cylinder.radius_m, 0.5 * cylinder.length_m);
  }
  std::unique_ptr<ShapeDistance> operator()(const MeshGeometry& geometry) const {
    if (!mesh) throw std::invalid_argument("mesh shape '" + geometry.file + "' was not loaded");
    return std::getenv("EXACT") ? makeMeshDistance(*mesh) : makeFieldDistance(*mesh);
  }
};

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

std::unique_ptr<ShapeDistance> makeShapeDistance(const CollisionShape& shape) {
  return std::visit(MakeDistance{shape.mesh.get()}, shape.geometry);
}

double smallestHalfExtent(const CollisionShape& shape) {
  return std::visit(HalfExtent{shape.mesh.get()}, shape.geometry);
}

}  // namespace tissue_contact
