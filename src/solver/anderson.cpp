#include "solver/anderson.h"

#include <Eigen/QR>
#include <algorithm>
#include <cassert>

namespace tissue_contact {

AndersonMixing::AndersonMixing(int depth) : depth_(depth), products_(depth, depth) {
  assert(1 <= depth && depth <= kMostSteps);
}

AndersonMixing::View AndersonMixing::next(const Eigen::Ref<const VectorX>& x, const Eigen::Ref<const VectorX>& g) {
  if (steps_ == 0) resize(x.size());
  residual() = g - x;
  const double size = residual().norm();
  if (steps_ > 0 && !(size <= least_)) steps_ = 0;
  if (steps_ == 0) {
    least_ = size;
  } else {
    remember(g);
    least_ = std::min(least_, size);
  }
  View next = vector(2 * depth_ + 3);
  next = g;
  mix(std::min(steps_, depth_), next);
  ++steps_;
  lastResidual() = residual();
  lastG() = g;
  return next;
}

void AndersonMixing::resize(Eigen::Index size) {
  size_ = size;
  store_.resize(static_cast<std::size_t>(size * (2 * depth_ + 4)));
}

void AndersonMixing::remember(const Eigen::Ref<const VectorX>& g) {
  const int column = (steps_ - 1) % depth_;
  residualChange(column) = residual() - lastResidual();
  gChange(column) = g - lastG();
  for (int other = 0; other < std::min(steps_, depth_); ++other) {
    const double product = residualChange(column).dot(residualChange(other));
    products_(column, other) = products_(other, column) = product;
  }
}

void AndersonMixing::mix(int known, View& next) {
  if (known == 0) return;
  Weights along(known);
  for (int k = 0; k < known; ++k) along[k] = residualChange(k).dot(residual());
  const Weights weights = products_.topLeftCorner(known, known).colPivHouseholderQr().solve(along);
  for (int k = 0; k < known; ++k) next -= weights[k] * gChange(k);
}

}  // namespace tissue_contact
