#include "contact/shape/soft_minimum.h"

#include <algorithm>

#include "mesh/surface/triangle_geometry.h"

namespace tissue_contact {

void SoftMinimum::add(const Vector3& weights, double value) {
  if (!accepts(value)) return;
  if (value < lowest_) {
    lowest_ = value;
    int kept = 0;
    for (int i = 0; i < count_; ++i) {
      if (candidates_[i].value < lowest_ + tolerance_) candidates_[kept++] = candidates_[i];
    }
    count_ = kept;
  }
  for (int i = 0; i < count_; ++i) {
    if ((candidates_[i].weights - weights).lpNorm<Eigen::Infinity>() < kSnapWeight) {
      candidates_[i].value = std::min(candidates_[i].value, value);
      return;
    }
  }
  // More than 64 distinct tied points do not occur (a clipped triangle has at most 9 corners); if they did, those found
  // first would do.
  if (count_ < static_cast<int>(candidates_.size())) candidates_[count_++] = {weights, value};
}

Vector3 SoftMinimum::weights() const {
  Vector3 sum = Vector3::Zero();
  double total = 0.0;
  for (int i = 0; i < count_; ++i) {
    const double share = 1.0 - (candidates_[i].value - lowest_) / tolerance_;
    sum += share * candidates_[i].weights;
    total += share;
  }
  return total > 0.0 ? Vector3(sum / total) : Vector3::UnitX();
}

}  // namespace tissue_contact
