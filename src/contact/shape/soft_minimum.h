/// @file
/// Room `contact`: picks the lowest of many candidate points of a triangle, and their mean where several are equally
/// low.
#pragma once

#include <array>
#include <limits>

#include "tissue_contact/core/types.h"

namespace tissue_contact {

/// The points where a convex function is least form a convex set: a point, a segment (a cylinder lying on a face) or an
/// area (flush faces). Given the values at that set's extreme points among others, this returns one point inside it
/// that moves continuously when the set tips over: the mean of all candidates within `tolerance` of the lowest, with
/// weights falling linearly to 0 at the tolerance. By convexity its value is within the tolerance of the minimum.
class SoftMinimum {
 public:
  /// @param ceiling candidates of this value or more do not count.
  explicit SoftMinimum(double tolerance, double ceiling = std::numeric_limits<double>::infinity())
      : tolerance_(tolerance), lowest_(ceiling - tolerance) {}

  /// A candidate: barycentric weights (>= 0, sum 1) and the function's value there. NaN values are ignored. Candidates
  /// that coincide count once: how often a point is found may depend on round-off.
  void add(const Vector3& weights, double value);

  /// Whether a candidate of this value would count.
  bool accepts(double value) const { return value < limit(); }
  double limit() const { return lowest_ + tolerance_; }

  double lowest() const { return lowest_; }  ///< one tolerance below the ceiling when nothing lower was added
  Vector3 weights() const;                   ///< barycentric; corner 0 when nothing was added

 private:
  struct Candidate {
    Vector3 weights;
    double value;
  };
  double tolerance_;
  double lowest_;
  int count_ = 0;
  std::array<Candidate, 64> candidates_;
};

}  // namespace tissue_contact
