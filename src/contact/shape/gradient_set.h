/// @file
/// Room `contact`, private: the gradients of a signed distance where it has a ridge, and the contact normal there.
#pragma once

#include <array>

#include "tissue_contact/core/types.h"

namespace tissue_contact {

/// The outward normals that meet at one point. Inside a shape, where two faces are equally near, the signed distance
/// has a ridge and no gradient; these are the gradients on its sides (the extreme points of Clarke's generalised
/// gradient).
class GradientSet {
 public:
  static constexpr int kMost = 8;

  int count() const { return count_; }
  const Vector3& operator[](int i) const { return gradients_[i]; }

  /// Of more than kMost, gives up one of the two that are nearest to each other: the set of their combinations changes by no
  /// more than the distance between these.
  void add(const Vector3& gradient) {
    gradients_[count_++] = gradient;
    if (count_ > kMost) dropOne();
  }

 private:
  void dropOne();

  int count_ = 0;
  std::array<Vector3, kMost + 1> gradients_;  ///< one more while add() chooses
};

/// The convex combination g of the gradients whose part along the tissue feature is smallest: |tangent * g| -> min.
/// At a minimum of the distance over a face (edge) some combination has no part along that face (edge) at all; that
/// one, not any of the gradients it is made of, is the direction of contact between, say, an instrument edge and a
/// tissue face. It is shorter than 1 on a ridge: moving along g / |g| by s changes the least distance by |g| s.
/// @param tangent projector onto the directions along the feature: I - n n^T for a face, e e^T for an edge
Vector3 stationaryGradient(const GradientSet& gradients, const Matrix3& tangent);

}  // namespace tissue_contact
