#include "contact/touching_shapes.h"

#include <algorithm>
#include <limits>

#include "contact/shape/shape_union.h"
#include "tissue_contact/contact/contact_detector.h"
#include "tissue_contact/core/entry_error.h"

namespace tissue_contact {

std::vector<TouchingShape> touchingShapes(const std::vector<Instrument>& instruments,
                                          const MeshPreparation& preparation) {
  ShapeDistances distances(preparation);
  std::vector<TouchingShape> result;
  for (std::size_t i = 0; i < instruments.size(); ++i) {
    const std::vector<ContactLink>& links = instruments[i].contactLinks();
    for (std::size_t l = 0; l < links.size(); ++l) {
      for (std::size_t s = 0; s < links[l].shapes.size(); ++s) {
        const CollisionShape& shape = links[l].shapes[s];
        auto distance = atEntry(elementOf(elementOf("instruments", i) + ".contact_links", l),
                                [&] { return distances.make(shape); });
        result.push_back({static_cast<int>(i), static_cast<int>(l), static_cast<int>(s), links[l].link, shape.X_LS,
                          std::move(distance), smallestHalfExtent(shape)});
      }
    }
  }
  return result;
}

namespace {

/// Whether a ray comes upon a shape: on by the distance, which no point of the shape is nearer than, until that is next to nothing, or the
/// shape lies behind.
bool meets(const PlacedShape& shape, const Vector3& from_W, const Vector3& direction_W, double tolerance) {
  constexpr int kMostSteps = 16;
  double way = 0.0;
  double before = std::numeric_limits<double>::infinity();
  for (int step = 0; step < kMostSteps; ++step) {
    const double distance = distanceAt(shape, from_W + way * direction_W).distance;
    if (distance < tolerance) return true;
    if (distance > before) return false;
    before = distance;
    way += distance;
  }
  return false;
}

}  // namespace

bool OtherShapes::closeWay(const Vector3& p_S, const Vector3& end_S, const Vector3& normal_S) const {
  const Pose X_WS = X_WL_[own_.link] * own_.X_LS;
  const Vector3 p_W = X_WS * p_S;
  const Vector3 end_W = X_WS * end_S;
  const Vector3 normal_W = X_WS.linear() * normal_S;
  const double way = (end_W - p_W).norm();
  return std::any_of(shapes_.begin(), shapes_.end(), [&](const TouchingShape& other) {
    if (&other == &own_ || other.instrument != own_.instrument) return false;
    const PlacedShape placed{other.distance.get(), X_WL_[other.link] * other.X_LS};
    const double reach = kGrooveRadius * std::min(own_.half_extent, other.half_extent);
    // No point of the way is nearer: distances change by no more than the way between points.
    if (0.5 * (distanceAt(placed, p_W).distance + distanceAt(placed, end_W).distance - way) < reach) return true;
    return meets(placed, end_W, normal_W, reach);
  });
}

}  // namespace tissue_contact
