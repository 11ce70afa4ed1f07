/// @file
/// Room `contact`: the lowest point of the maximum of linear functions over a triangle, exactly.
#pragma once

#include <array>
#include <limits>

#include "tissue_contact/core/types.h"

namespace tissue_contact {

/// Linear functions on a triangle, each given by its values at the three corners.
class PlaneSet {
 public:
  static constexpr int kCapacity = 8;
  using Values = Eigen::Array<double, kCapacity, 1>;

  PlaneSet();
  int count() const { return count_; }
  bool full() const { return count_ == kCapacity; }
  void add(const Vector3& corner_values);
  Vector3 cornerValues(int i) const { return {at_[0][i], at_[1][i], at_[2][i]}; }
  void remove(int i);  ///< keeps the order of the others

  double valueAt(int i, const Vector3& weights) const { return cornerValues(i).dot(weights); }
  double maximumAt(const Vector3& weights) const {
    return (at_[0] * weights[0] + at_[1] * weights[1] + at_[2] * weights[2]).maxCoeff();
  }
  /// Of all functions at parameter `u` of edge `edge` (from that corner to the next); below all sense from count() on.
  Values valuesOnEdge(int edge, double u) const { return at_[edge] * (1.0 - u) + at_[(edge + 1) % 3] * u; }

 private:
  int count_ = 0;
  std::array<Values, 3> at_;  ///< by corner; the processor takes several at a time
};

struct PlaneMinimum {
  Vector3 weights;  ///< barycentric; where the minimum is not unique, a point well inside its set (see SoftMinimum)
  double value;     ///< the maximum of the functions there
};

/// Tries every point that can be an extreme point of the minimum: corners, crossings of two functions on an edge, of
/// three inside. With the few functions met here this beats a simplex method and cannot cycle.
/// @param tolerance values that differ by less are equally low (unit of the functions)
/// @param ceiling a minimum of this or more need not be found: what is returned then is some point no lower
PlaneMinimum minimiseMaximum(const PlaneSet& planes, double tolerance,
                             double ceiling = std::numeric_limits<double>::infinity());

}  // namespace tissue_contact
