#include "contact/leaving_face.h"

#include <algorithm>
#include <limits>

namespace tissue_contact {

SignedDistance leavingFace(const ShapeDistance& shape, const Vector3& p_S, const Vector3& outward_S, double edge_m,
                           const SignedDistance& here) {
  constexpr double kAcross = 0.8;      // cosine
  constexpr double kInset = 1e-3;      // of the shape's size: far enough inside to tell in from out
  constexpr double kBehindEdge = 2.0;  // radii: behind where it is round
  constexpr double kDeepest = 0.5;     // of an edge
  constexpr int kHalvings = 20;        // of half an edge: to a millionth
  if (!shape.hasFlatParts() || outward_S.isZero(0.0) || here.normal.dot(-outward_S) >= kAcross) return here;
  const Vector3 along = (-outward_S + outward_S.dot(here.normal) * here.normal).normalized();
  const Vector3 from =
      p_S - (std::max(here.distance, 0.0) + kInset * shape.size() + kBehindEdge * shape.edgeRadius()) * here.normal;
  double inside = 0.0;
  double outside = kDeepest * edge_m;
  if (!(shape.at(from).distance < 0.0) || shape.at(from + outside * along).distance < 0.0) return here;
  for (int k = 0; k < kHalvings; ++k) {
    const double middle = 0.5 * (inside + outside);
    (shape.at(from + middle * along).distance < 0.0 ? inside : outside) = middle;
  }
  const Vector3 normal = shape.at(from + inside * along).normal;
  if (normal.dot(-outward_S) < kAcross) return here;
  if (here.distance > 0.0) return {std::numeric_limits<double>::infinity(), normal};
  return {-inside * normal.dot(along), normal};
}

}  // namespace tissue_contact
