/// @file
/// Room `contact`: the lowest point of the maximum of linear functions over a triangle, exactly.
#pragma once

#include <array>

#include "tissue_contact/core/types.h"

namespace tissue_contact {

/// Linear functions on a triangle, each given by its values at the three corners.
class PlaneSet {
 public:
  static constexpr int kCapacity = 8;

  int count() const { return count_; }
  bool full() const { return count_ == kCapacity; }
  void add(const Vector3& corner_values) { values_[count_++] = corner_values; }
  const Vector3& cornerValues(int i) const { return values_[i]; }
  void remove(int i);  ///< keeps the order of the others

  double valueAt(int i, const Vector3& weights) const { return values_[i].dot(weights); }
  double maximumAt(const Vector3& weights) const;

 private:
  int count_ = 0;
  std::array<Vector3, kCapacity> values_;
};

struct PlaneMinimum {
  Vector3 weights;  ///< barycentric; where the minimum is not unique, a point well inside its set (see SoftMinimum)
  double value;     ///< the maximum of the functions there
};

/// Tries every point that can be an extreme point of the minimum: corners, crossings of two functions on an edge, of
/// three inside. With the few functions met here this beats a simplex method and cannot cycle.
/// @param tolerance values that differ by less are equally low (unit of the functions)
PlaneMinimum minimiseMaximum(const PlaneSet& planes, double tolerance);

}  // namespace tissue_contact
