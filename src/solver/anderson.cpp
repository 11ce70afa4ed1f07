#include "solver/anderson.h"

#include <Eigen/QR>
#include <algorithm>
#include <utility>

namespace tissue_contact {

AndersonMixing::AndersonMixing(int depth) : depth_(depth), products_(depth, depth) {}

Eigen::VectorBlock<const VectorX> AndersonMixing::next(const Eigen::Ref<const VectorX>& x,
                                                       const Eigen::Ref<const VectorX>& g) {
  reserve(x.size());
  residual_.head(size_) = g - x;
  const double residual = residual_.head(size_).norm();
  if (steps_ > 0 && !(residual <= least_)) {
    steps_ = 0;
    ++setbacks_;
  }
  if (steps_ > 0) remember(g);
  least_ = steps_ == 0 ? residual : std::min(least_, residual);
  last_residual_.head(size_) = residual_.head(size_);
  last_g_.head(size_) = g;
  next_.head(size_) = g;
  mix(std::min(steps_, depth_));
  ++steps_;
  return std::as_const(next_).head(size_);
}

void AndersonMixing::reserve(Eigen::Index size) {
  if (steps_ > 0) return;
  size_ = size;
  if (size <= residual_.size()) return;
  residual_changes_.resize(size, depth_);
  g_changes_.resize(size, depth_);
  for (VectorX* const vector : {&residual_, &last_residual_, &last_g_, &next_}) vector->resize(size);
}

void AndersonMixing::remember(const Eigen::Ref<const VectorX>& g) {
  const int column = (steps_ - 1) % depth_;
  const auto change = [&](int k) { return residual_changes_.col(k).head(size_); };
  change(column) = residual_.head(size_) - last_residual_.head(size_);
  g_changes_.col(column).head(size_) = g - last_g_.head(size_);
  for (int other = 0; other < std::min(steps_, depth_); ++other) {
    products_(column, other) = products_(other, column) = change(column).dot(change(other));
  }
}

void AndersonMixing::mix(int known) {
  if (known == 0) return;
  Weights along(known);
  for (int k = 0; k < known; ++k) along[k] = residual_changes_.col(k).head(size_).dot(residual_.head(size_));
  const Weights weights = products_.topLeftCorner(known, known).colPivHouseholderQr().solve(along);
  for (int k = 0; k < known; ++k) next_.head(size_) -= weights[k] * g_changes_.col(k).head(size_);
}

std::size_t AndersonMixing::bytes() const {
  const Eigen::Index values = residual_changes_.size() + g_changes_.size() + residual_.size() + last_residual_.size() +
                              last_g_.size() + next_.size();
  return sizeof(double) * static_cast<std::size_t>(values);
}

}  // namespace tissue_contact
