#include "contact/shape/plane_minimum.h"

#include <algorithm>
#include <limits>

#include "contact/shape/soft_minimum.h"
#include "core/lanes.h"
#include "mesh/surface/triangle_geometry.h"

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

/// Two points of the rim; between them two functions are equal.
struct Line {
  std::array<int, 2> edge;
  std::array<double, 2> u;       ///< along the edge
  std::array<bool, 2> is_inner;  ///< of the edge; else its first corner
};

/// Where a function with these values at the corners is 0.
/// @return false when that is nowhere inside.
bool findLine(const Vector3& difference, Line& line) {
  if (!(difference.minCoeff() < 0.0 && difference.maxCoeff() > 0.0)) return false;
  int count = 0;
  for (int edge = 0; edge < 3 && count < 2; ++edge) {
    const double from = difference[edge];
    const double to = difference[(edge + 1) % 3];
    const bool crosses = from < 0.0 ? to > 0.0 : from > 0.0 && to < 0.0;
    if (!crosses && from != 0.0) continue;
    line.edge[count] = edge;
    line.u[count] = from / (from - to);
    line.is_inner[count++] = crosses;
  }
  return count == 2;
}

/// Collects the points that may be lowest.
class Candidates {
 public:
  Candidates(const PlaneSet& planes, double tolerance, double ceiling)
      : planes_(planes), minimum_(tolerance, ceiling) {}

  TISSUE_CONTACT_INLINE void offer(const Vector3& weights) {
    const double value = planes_.maximumAt(weights);
    if (minimum_.accepts(value)) minimum_.add(weights, value);
  }

  /// Whether all functions may be low enough at one point of the line.
  TISSUE_CONTACT_INLINE bool mayAccept(const Line& line) const {
    constexpr double kRoundOff = 1e-9;
    const PlaneSet::Values at_from = planes_.valuesOnEdge(line.edge[0], line.u[0]) - minimum_.limit();
    const PlaneSet::Values at_to = planes_.valuesOnEdge(line.edge[1], line.u[1]) - minimum_.limit();
    if (at_from.min(at_to).maxCoeff() >= 0.0) return false;
    // Without a branch per function, which no processor would guess. A crossing is used only where the signs differ.
    const PlaneSet::Values crossing = at_from / (at_from - at_to);
    PlaneSet::Values rising;
    PlaneSet::Values falling;
    for (int k = 0; k < PlaneSet::kCapacity; ++k) {
      falling[k] = at_from[k] >= 0.0 ? crossing[k] : 0.0;
      rising[k] = at_to[k] >= 0.0 ? crossing[k] : 1.0;
    }
    const double from = falling.maxCoeff();
    const double to = rising.minCoeff();
    return from <= to + kRoundOff;
  }

  Vector3 weights() const { return minimum_.weights(); }

 private:
  const PlaneSet& planes_;
  SoftMinimum minimum_;
};

TISSUE_CONTACT_INLINE void offerInnerCrossing(const Vector3& first, const Vector3& second, Candidates& candidates) {
  const Vector3 direction = first.cross(second);
  const double sum = direction.sum();
  if (!(sum > 0.0 ? direction.minCoeff() > 0.0 : direction.maxCoeff() < 0.0)) return;
  candidates.offer(direction / sum);
}

}  // namespace

PlaneSet::PlaneSet() {
  constexpr double kNone = -1e300;  // never the largest; finite, as 0 times infinity is no number
  at_.fill(Values::Constant(kNone));
}

void PlaneSet::add(const Vector3& corner_values) {
  for (int corner = 0; corner < 3; ++corner) at_[corner][count_] = corner_values[corner];
  ++count_;
}

void PlaneSet::remove(int i) {
  PlaneSet kept;
  for (int k = 0; k < count_; ++k) {
    if (k != i) kept.add(cornerValues(k));
  }
  *this = kept;
}

TISSUE_CONTACT_CLONES PlaneMinimum minimiseMaximum(const PlaneSet& all_planes, double tolerance, double ceiling) {
  const PlaneSet planes = relevant(all_planes);
  Candidates candidates(planes, tolerance, ceiling);
  for (int corner = 0; corner < 3; ++corner) candidates.offer(Vector3::Unit(corner));
  for (int i = 0; i < planes.count(); ++i) {
    for (int j = i + 1; j < planes.count(); ++j) {
      const Vector3 difference = planes.cornerValues(i) - planes.cornerValues(j);
      Line line;
      if (!findLine(difference, line) || !candidates.mayAccept(line)) continue;
      for (int end = 0; end < 2; ++end) {
        if (line.is_inner[end]) candidates.offer(weightsOnEdge(line.edge[end], line.u[end]));
      }
      for (int k = j + 1; k < planes.count(); ++k) {
        offerInnerCrossing(difference, planes.cornerValues(i) - planes.cornerValues(k), candidates);
      }
    }
  }
  const Vector3 weights = candidates.weights();
  return {weights, planes.maximumAt(weights)};
}

}  // namespace tissue_contact
