#include "solver/anderson.h"

#include <Eigen/QR>
#include <algorithm>

namespace tissue_contact {

VectorX AndersonMixing::next(const VectorX& x, const VectorX& g) {
  const VectorX residual = g - x;
  const double size = residual.norm();
  if (steps_ > 0 && !(size <= least_)) steps_ = 0;
  if (steps_ == 0) {
    residual_changes_.resize(x.size(), depth_);
    g_changes_.resize(x.size(), depth_);
    least_ = size;
  } else {
    const int column = (steps_ - 1) % depth_;
    residual_changes_.col(column) = residual - residual_;
    g_changes_.col(column) = g - g_;
    least_ = std::min(least_, size);
  }
  residual_ = residual;
  g_ = g;
  const int known = std::min(steps_, depth_);
  ++steps_;
  if (known == 0) return g;
  const VectorX weights = residual_changes_.leftCols(known).colPivHouseholderQr().solve(residual);
  return g - g_changes_.leftCols(known) * weights;
}

}  // namespace tissue_contact
