#include "tissue_contact/mesh/convex_body.h"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "mesh/edge_table.h"
#include "tissue_contact/mesh/tet_mesh.h"

namespace tissue_contact {

namespace {

constexpr double kRounding = 1e-9;  // of the size

double sizeOf(const NodalVectors& x) { return (x.rowwise().maxCoeff() - x.rowwise().minCoeff()).norm(); }

Vector3 normalOf(const NodalVectors& x, const Triangle& t) {
  return (x.col(t[1]) - x.col(t[0])).cross(x.col(t[2]) - x.col(t[0])).normalized();
}

std::vector<bool> nodesOn(const std::vector<Triangle>& surface, Eigen::Index count) {
  std::vector<bool> on_surface(count, false);
  for (const Triangle& t : surface) {
    for (const int node : t) on_surface[node] = true;
  }
  return on_surface;
}

/// Every node against every triangle.
bool isBehindAll(const NodalVectors& x, const std::vector<Triangle>& surface) {
  const std::vector<bool> on_surface = nodesOn(surface, x.cols());
  const double rounding = kRounding * sizeOf(x);
  for (const Triangle& t : surface) {
    const Vector3 n = normalOf(x, t);
    const double most = n.dot(x.col(t[0])) + rounding;
    for (Eigen::Index i = 0; i < x.cols(); ++i) {
      if (on_surface[i] && !(n.dot(x.col(i)) <= most)) return false;
    }
  }
  return true;
}

/// Whether a triangle is so low that its neighbours meet it within the rounding at any angle: a fold could hide between two of them.
bool hasLowTriangle(const NodalVectors& x, const std::vector<Triangle>& surface) {
  constexpr double kLow =
      1e5;  // roundings: an edge that passes for flat is bent inwards by 1e-5 at most, ten thousand in a row by .1
  const double least = kLow * kRounding * sizeOf(x);
  return std::any_of(surface.begin(), surface.end(), [&](const Triangle& t) {
    const Vector3 a = x.col(t[1]) - x.col(t[0]);
    const Vector3 b = x.col(t[2]) - x.col(t[0]);
    const double longest = std::sqrt(std::max({a.squaredNorm(), b.squaredNorm(), (a - b).squaredNorm()}));
    return !(a.cross(b).norm() > least * longest);
  });
}

/// Whether no edge is bent inwards, each between two triangles.
bool isConvexAtEdges(const NodalVectors& x, const std::vector<Triangle>& surface) {
  const EdgeTable table(surface);
  const double rounding = kRounding * sizeOf(x);
  for (const EdgeTable::Edge& edge : table) {
    const EdgeTable::Uses uses = table.usesOf(edge);
    if (uses.size() != 2 || uses[0].forward == uses[1].forward) return false;
    for (const int i : {0, 1}) {
      const Triangle& here = surface[uses[i].triangle];
      const Triangle& there = surface[uses[1 - i].triangle];
      const Vector3 opposite = x.col(there[(uses[1 - i].side + 2) % 3]) - x.col(here[0]);
      if (!(normalOf(x, here).dot(opposite) <= rounding)) return false;
    }
  }
  return true;
}

/// Whether a ray from the middle of the nodes, in whatever direction, leaves through one triangle: all are seen from behind, and
/// their solid angles (Van Oosterom and Strackee 1983) make one sphere.
bool isSeenOnce(const NodalVectors& x, const std::vector<Triangle>& surface) {
  const std::vector<bool> on_surface = nodesOn(surface, x.cols());
  Vector3 middle = Vector3::Zero();
  for (Eigen::Index i = 0; i < x.cols(); ++i) middle += on_surface[i] ? Vector3(x.col(i)) : Vector3::Zero();
  middle /= static_cast<double>(std::count(on_surface.begin(), on_surface.end(), true));
  double angle = 0.0;
  for (const Triangle& t : surface) {
    const Vector3 a = x.col(t[0]) - middle;
    const Vector3 b = x.col(t[1]) - middle;
    const Vector3 c = x.col(t[2]) - middle;
    const double triple = a.dot(b.cross(c));
    if (!(triple > 0.0)) return false;
    const double la = a.norm();
    const double lb = b.norm();
    const double lc = c.norm();
    angle += 2.0 * std::atan2(triple, la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
  }
  return std::abs(angle - 4.0 * M_PI) < 2.0 * M_PI;
}

}  // namespace

bool isConvex(const NodalVectors& x, const std::vector<Triangle>& surface) {
  if (surface.empty()) return false;
  if (hasLowTriangle(x, surface)) return isBehindAll(x, surface);
  // A surface around a point that each ray from there meets once, and that is nowhere bent inwards, is convex (Devillers,
  // Liotta, Preparata, Tamassia 1998, "Checking the convexity of polytopes and the planarity of subdivisions").
  return isConvexAtEdges(x, surface) && isSeenOnce(x, surface);
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
