#include "tissue_contact/mesh/convex_body.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "tissue_contact/mesh/tet_mesh.h"

namespace tissue_contact {

bool isConvex(const NodalVectors& x, const std::vector<Triangle>& surface) {
  constexpr double kRounding = 1e-9;
  std::vector<bool> on_surface(x.cols(), false);
  for (const Triangle& t : surface) {
    for (const int node : t) on_surface[node] = true;
  }
  const Vector3 size = x.rowwise().maxCoeff() - x.rowwise().minCoeff();
  for (const Triangle& t : surface) {
    const Vector3 n = (x.col(t[1]) - x.col(t[0])).cross(x.col(t[2]) - x.col(t[0])).normalized();
    const double most = n.dot(x.col(t[0])) + kRounding * size.norm();
    for (Eigen::Index i = 0; i < x.cols(); ++i) {
      if (on_surface[i] && !(n.dot(x.col(i)) <= most)) return false;
    }
  }
  return !surface.empty();
}

ConvexBody::ConvexBody(const NodalVectors& rest, const std::vector<Tetrahedron>& tetrahedra) : measured_at_(rest) {
  for (const Tetrahedron& nodes : tetrahedra) {
    const Matrix3 inverse = edgeMatrix(rest, nodes).inverse();
    elements_.push_back({nodes, inverse});
    // F changes by the sum of dx_i grad N_i' over the nodes; grad N_1..N_3 are the rows of D^-1, grad N_0 is minus their sum.
    steepest_ = std::max(steepest_, inverse.rowwise().norm().sum() + inverse.colwise().sum().norm());
  }
}

double ConvexBody::strain(const Element& element, const NodalVectors& x) const {
  return (edgeMatrix(x, element.nodes) * element.rest_inverse - Matrix3::Identity()).norm();
}

bool ConvexBody::cannotFold(const NodalVectors& x, double travel_m) {
  const double on_the_way = steepest_ * travel_m;
  if (elements_.empty() || !(strain(elements_[worst_], x) < kMostStrain)) return false;
  const double moved = std::sqrt((x - measured_at_).colwise().squaredNorm().maxCoeff());
  const double bound = strain_ + steepest_ * moved;
  if (bound < kMostStrain && bound + on_the_way < 1.0) return true;
  double largest = 0.0;
  for (std::size_t e = 0; e < elements_.size(); ++e) {
    const double here = strain(elements_[e], x);
    if (!(here < kMostStrain)) {
      worst_ = e;
      return false;
    }
    largest = std::max(largest, here);
  }
  measured_at_ = x;
  strain_ = largest;
  return largest + on_the_way < 1.0;
}

}  // namespace tissue_contact
