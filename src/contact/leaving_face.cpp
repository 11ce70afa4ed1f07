#include "contact/leaving_face.h"

namespace tissue_contact {

SignedDistance leavingFace(const ShapeDistance& shape, const Vector3& p_S, const VertexSurroundings& around,
                           const SignedDistance& here, const ShapesBeside* beside) {
  constexpr double kAcross = 0.8;      // cosine; an edge turns the normal by as much
  constexpr double kFacesSide = -0.7;  // cosine: a triangle that the side pushes
  constexpr double kInset = 1e-3;      // of the shape's smallest half extent: far enough inside to tell in from out
  constexpr double kBehindEdge = 1.0;  // radii of a rounded edge: behind where it is round
  constexpr double kDeepest = 0.5;     // of an edge
  constexpr int kHalvings = 20;        // of half an edge: to a millionth
  if (around.outward.isZero(0.0) || around.least_facing < kFacesSide) return here;
  const Vector3 inward = -around.outward.normalized();
  if (here.normal.dot(inward) >= kAcross) return here;
  const Vector3 along = (inward - inward.dot(here.normal) * here.normal).normalized();
  const double inset = kInset * shape.halfExtents(Matrix3::Identity()).minCoeff() + kBehindEdge * shape.edgeRadius();
  const Vector3 from = p_S - (std::max(here.distance, 0.0) + inset) * here.normal;
  double inside = 0.0;
  double outside = kDeepest * around.shortest_edge;
  if (!(shape.at(from).distance < 0.0) || shape.at(from + outside * along).distance < 0.0) return here;
  for (int k = 0; k < kHalvings; ++k) {
    const double middle = 0.5 * (inside + outside);
    (shape.at(from + middle * along).distance < 0.0 ? inside : outside) = middle;
  }
  const Vector3 end = from + inside * along;
  const Vector3 normal = shape.at(end).normal;
  if (normal.dot(inward) < kAcross || normal.dot(here.normal) > kAcross) return here;
  if (beside != nullptr && beside->closeWay(p_S, end, normal)) return here;
  if (here.distance > 0.0) return {std::numeric_limits<double>::infinity(), normal};
  return {std::max(normal.dot(p_S - end), here.distance), normal};
}

}  // namespace tissue_contact
