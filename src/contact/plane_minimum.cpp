#include "contact/plane_minimum.h"

#include <algorithm>
#include <limits>

#include "contact/soft_minimum.h"
#include "contact/triangle_geometry.h"

namespace tissue_contact {
namespace {

/// The functions that can be the largest somewhere near the minimum: the minimum is nowhere below the largest of the
/// functions' own minima, so functions that stay below that everywhere never matter.
PlaneSet relevant(const PlaneSet& planes) {
  double bound = -std::numeric_limits<double>::infinity();
  for (int i = 0; i < planes.count(); ++i) bound = std::max(bound, planes.cornerValues(i).minCoeff());
  PlaneSet result;
  for (int i = 0; i < planes.count(); ++i) {
    if (planes.cornerValues(i).maxCoeff() >= bound) result.add(planes.cornerValues(i));
  }
  return result;
}

/// Offers a point where function `i` is one of the largest.
void offer(const PlaneSet& planes, int i, const Vector3& weights, SoftMinimum& minimum) {
  if (minimum.accepts(planes.valueAt(i, weights))) minimum.add(weights, planes.maximumAt(weights));
}

void addEdgeCrossings(const PlaneSet& planes, int i, const Vector3& difference, SoftMinimum& minimum) {
  for (int edge = 0; edge < 3; ++edge) {
    const double from = difference[edge];
    const double to = difference[(edge + 1) % 3];
    if (from * to < 0.0) offer(planes, i, weightsOnEdge(edge, from / (from - to)), minimum);
  }
}

void addInnerCrossing(const PlaneSet& planes, int i, const Vector3& first, const Vector3& second,
                      SoftMinimum& minimum) {
  const Vector3 direction = first.cross(second);
  const double sum = direction.sum();
  if (!(sum != 0.0)) return;
  const Vector3 weights = direction / sum;
  if (weights.minCoeff() > 0.0) offer(planes, i, weights, minimum);
}

}  // namespace

void PlaneSet::remove(int i) {
  for (int k = i; k + 1 < count_; ++k) values_[k] = values_[k + 1];
  --count_;
}

double PlaneSet::maximumAt(const Vector3& weights) const {
  double maximum = -std::numeric_limits<double>::infinity();
  for (int i = 0; i < count_; ++i) maximum = std::max(maximum, valueAt(i, weights));
  return maximum;
}

PlaneMinimum minimiseMaximum(const PlaneSet& all_planes, double tolerance) {
  const PlaneSet planes = relevant(all_planes);
  SoftMinimum minimum(tolerance);
  for (int corner = 0; corner < 3; ++corner) {
    const Vector3 weights = Vector3::Unit(corner);
    minimum.add(weights, planes.maximumAt(weights));
  }
  for (int i = 0; i < planes.count(); ++i) {
    for (int j = i + 1; j < planes.count(); ++j) {
      const Vector3 difference = planes.cornerValues(i) - planes.cornerValues(j);
      addEdgeCrossings(planes, i, difference, minimum);
      for (int k = j + 1; k < planes.count(); ++k) {
        addInnerCrossing(planes, i, difference, planes.cornerValues(i) - planes.cornerValues(k), minimum);
      }
    }
  }
  const Vector3 weights = minimum.weights();
  return {weights, planes.maximumAt(weights)};
}

}  // namespace tissue_contact
