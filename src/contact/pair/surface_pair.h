/// @file
/// Room `contact`: two tissue surfaces that may touch, and what makes a pair of their points a contact.
#pragma once

#include <algorithm>
#include <vector>

#include "mesh/surface/moving_surface.h"
#include "tissue_contact/contact/contact.h"

namespace tissue_contact {

/// A material point of a surface: barycentric over three nodes, of which those of weight 0 do not matter.
struct SurfacePoint {
  Triangle nodes = {0, 0, 0};
  Vector3 weights = Vector3::UnitX();

  Vector3 in(const NodalVectors& positions) const { return pointOf(positions, nodes, weights); }
};

/// For one call; the surfaces are placed. `own` becomes Contact's `tissue`, `other` takes the place of the
/// instrument.
struct SurfacePair {
  MovingSurface& own;
  MovingSurface& other;
  double margin;  ///< pairs of points with a gap above it do not count, m

  bool folds() const { return &own == &other; }

  /// Distance at which the middle surfaces touch, m: half the thickness of each.
  double apart() const { return own.halfThickness() + other.halfThickness(); }

  /// How far middle surfaces can be from each other in a contact that does not penetrate, m.
  double reach() const { return margin + apart(); }

  /// A volume's surface holds back what lies at most so deep below it, m: half an edge, and not past the middle of
  /// either body. For folds it is half as much: between the two sides of a part that is compressed no geometry tells
  /// whether they have passed each other.
  double depth() const {
    const double half = 0.5 * std::min({size(), own.smallestExtent(), other.smallestExtent()});
    return std::max(folds() ? 0.5 * half : half, apart());
  }

  /// Length by which tolerances are measured, m.
  double size() const { return std::min(own.meanEdge(), other.meanEdge()); }

  /// Whether two points of one surface belong together at rest: within an edge of each other, or so near that a sheet
  /// of this thickness cannot be folded between them (the inside of a fold of thickness t is pi/2 t long).
  bool nearAtRest(const SurfacePoint& on_own, const SurfacePoint& on_other) const;

  /// Appends a contact unless none of its nodes can move.
  /// @param n from `other` into `own`, unit.
  /// @param distance between the middle surfaces along n, m.
  void add(const SurfaceFeature& own_feature, const SurfacePoint& on_own, const SurfaceFeature& other_feature,
           const SurfacePoint& on_other, const Vector3& n, double distance, std::vector<Contact>& contacts) const;
};

}  // namespace tissue_contact
