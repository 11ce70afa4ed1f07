#include "solver/anderson.h"

#include <Eigen/QR>
#include <algorithm>
#include <cassert>

namespace tissue_contact {

AndersonMixing::AndersonMixing(int depth) : depth_(depth), products_(depth, depth) {
  assert(1 <= depth && depth <= kMostSteps);
}

const VectorX& AndersonMixing::next(const VectorX& x, const VectorX& g) {
  residual_ = g - x;
  const double size = residual_.norm();
  if (steps_ > 0 && !(size <= least_)) steps_ = 0;
  if (steps_ == 0) {
    residual_changes_.resize(x.size(), depth_);
    g_changes_.resize(x.size(), depth_);
    least_ = size;
  } else {
    remember(g);
    least_ = std::min(least_, size);
  }
  next_ = g;
  mix(std::min(steps_, depth_));
  ++steps_;
  last_residual_.swap(residual_);
  last_g_ = g;
  return next_;
}

void AndersonMixing::remember(const VectorX& g) {
  const int column = (steps_ - 1) % depth_;
  residual_changes_.col(column) = residual_ - last_residual_;
  g_changes_.col(column) = g - last_g_;
  for (int other = 0; other < std::min(steps_, depth_); ++other) {
    const double product = residual_changes_.col(column).dot(residual_changes_.col(other));
    products_(column, other) = products_(other, column) = product;
  }
}

void AndersonMixing::mix(int known) {
  if (known == 0) return;
  Weights along(known);
  for (int k = 0; k < known; ++k) along[k] = residual_changes_.col(k).dot(residual_);
  const Weights weights = products_.topLeftCorner(known, known).colPivHouseholderQr().solve(along);
  for (int k = 0; k < known; ++k) next_ -= weights[k] * g_changes_.col(k);
}

}  // namespace tissue_contact
