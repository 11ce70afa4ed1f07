/// @file
/// Room `contact`: sphere.
#include "contact/shape/shape_distance.h"

namespace tissue_contact {
namespace {

class SphereDistance : public ShapeDistance {
 public:
  explicit SphereDistance(double radius) : radius_(radius) {}

  double size() const override { return radius_; }
  Vector3 halfExtents(const Matrix3&) const override { return Vector3::Constant(radius_); }
  bool hasFlatParts() const override { return false; }

  SignedDistance at(const Vector3& p_S) const override {
    const double from_centre = p_S.norm();
    if (!(from_centre > 0.0)) return {-radius_, Vector3::UnitX()};  // every direction is a gradient here
    return {from_centre - radius_, p_S / from_centre};
  }

  bool closest(const TrianglePoints& triangle, double margin, ClosestPoint& result) const override {
    if (std::abs(triangle.corners[0].dot(triangle.normal)) > radius_ + margin) return false;
    result.weights = projectOnTriangle(triangle.corners, Vector3::Zero());
    const SignedDistance nearest = at(triangle.pointAt(result.weights));
    result.distance = nearest.distance;
    result.gradients = GradientSet();
    result.gradients.add(nearest.normal);
    return nearest.distance <= margin;
  }

 private:
  double radius_;
};

}  // namespace

std::unique_ptr<ShapeDistance> makeSphereDistance(double radius) { return std::make_unique<SphereDistance>(radius); }

}  // namespace tissue_contact
