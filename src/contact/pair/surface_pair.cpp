#include "contact/pair/surface_pair.h"

namespace tissue_contact {
namespace {

double longestEdge(const MovingSurface& surface, const SurfacePoint& point) {
  double longest = 0.0;
  for (int i = 0; i < 3; ++i) {
    if (point.weights[i] > 0.0) longest = std::max(longest, surface.longestEdge(point.nodes[i]));
  }
  return longest;
}

/// The point among the corners of a triangle that its feature is of, for whoever asks how a sheet turns there.
SurfacePoint inTriangle(const MovingSurface& surface, const SurfaceFeature& feature, const SurfacePoint& point) {
  if (surface.halfThickness() == 0.0) return point;
  SurfacePoint among{point.nodes, Vector3::Zero()};
  surface.anyTriangleOf(feature, [&](int first) {
    among.nodes = surface.triangles()[first];
    return true;
  });
  for (int i = 0; i < 3; ++i) {
    for (int k = 0; k < 3; ++k) {
      if (among.nodes[i] == point.nodes[k]) among.weights[i] += point.weights[k];
    }
  }
  return among;
}

}  // namespace

bool SurfacePair::nearAtRest(const SurfacePoint& on_own, const SurfacePoint& on_other) const {
  if (!folds()) return false;
  constexpr double kTightestFold = 1.5;  // of the thickness; just below pi / 2
  const double length = std::max({longestEdge(own, on_own), longestEdge(other, on_other), kTightestFold * apart()});
  return !((on_own.in(own.rest()) - on_other.in(other.rest())).norm() > length);
}

void SurfacePair::add(const SurfaceFeature& own_feature, const SurfacePoint& on_own,
                      const SurfaceFeature& other_feature, const SurfacePoint& on_other, const Vector3& n,
                      double distance, std::vector<Contact>& contacts) const {
  if (own.isHeld(on_own.nodes, on_own.weights) && other.isHeld(on_other.nodes, on_other.weights)) return;
  Contact& contact = contacts.emplace_back();
  contact.key.tissue = own.tissue();
  contact.key.feature = own_feature;
  contact.key.other_tissue = other.tissue();
  contact.key.other_feature = other_feature;
  const SurfacePoint own_point = inTriangle(own, own_feature, on_own);
  const SurfacePoint other_point = inTriangle(other, other_feature, on_other);
  contact.nodes = own_point.nodes;
  contact.weights = own_point.weights;
  contact.other_nodes = other_point.nodes;
  contact.other_weights = other_point.weights;
  contact.p_WC = on_own.in(own.positions());
  contact.R_WC = contactFrame(n);
  contact.gap_m = distance - apart();
}

}  // namespace tissue_contact
