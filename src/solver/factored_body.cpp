#include "solver/factored_body.h"

#include <algorithm>
#include <limits>

namespace tissue_contact {
namespace {

/// The factor serves while the scales in A change by less than this ratio: P^-1 A then stays well inside (0, 2), where
/// the relaxation converges.
constexpr double kScaleRatio = 1.25;

/// Touched nodes (72 bytes times their square) kept from step to step. More are kept while their number has not doubled
/// since they were last thrown away, so that a large contact does not compute its compliances anew in every step.
constexpr std::size_t kMostNodes = 1000;

bool isNear(double now, double then) { return now <= kScaleRatio * then && then <= kScaleRatio * now; }

}  // namespace

bool FactoredBody::prepare(const BodySystem& body) {
  const bool close = isNear(body.stiffness_scale, stiffness_scale_) && isNear(body.damping_scale, damping_scale_) &&
                     isNear(body.mass.sum(), total_mass_);
  const bool outdated = !valid_ || stale_ || !close;
  if (outdated) renew(body);
  return outdated;
}

void FactoredBody::renew(const BodySystem& body) {
  system_.assemble(body);
  if (!analysed_) factor_.analyzePattern(system_.matrix());
  analysed_ = true;
  factor_.factorize(system_.matrix());
  const Eigen::Map<const VectorX> values(system_.matrix().valuePtr(), system_.matrix().nonZeros());
  valid_ = factor_.info() == Eigen::Success && values.allFinite();
  stale_ = false;
  stiffness_scale_ = body.stiffness_scale;
  damping_scale_ = body.damping_scale;
  total_mass_ = body.mass.sum();
  index_of_.resize(body.K->rows(), -1);
  forget();
}

void FactoredBody::forget() {
  touched_.clear();
  std::fill(index_of_.begin(), index_of_.end(), -1);
}

void FactoredBody::relax(const NodalVectors& defect, NodalVectors& v) {
  if (system_.size() == 0) return;
  if (!valid_) {  // A was not positive definite: no answer, which the caller must see
    v.setConstant(std::numeric_limits<double>::quiet_NaN());
    return;
  }
  system_.gather(defect, right_);
  solve();
  system_.scatterAdd(left_, v);
}

/// left_ = P^-1 right_. What factor_.solve() does, without the vectors that it allocates.
void FactoredBody::solve() {
  permuted_.noalias() = factor_.permutationP() * right_;
  factor_.matrixL().solveInPlace(permuted_);
  factor_.matrixU().solveInPlace(permuted_);
  left_.noalias() = factor_.permutationPinv() * permuted_;
}

void FactoredBody::beginTouching() {
  if (touched_.size() > kMostNodes && touched_.size() > 2 * touched_before_) forget();
  touched_before_ = touched_.size();
}

int FactoredBody::touch(int node) {
  const int row = system_.firstRow(node);
  if (!valid_ || row < 0) return -1;
  if (index_of_[node] >= 0) return index_of_[node];
  const auto added = static_cast<Eigen::Index>(touched_.size());
  index_of_[node] = static_cast<int>(added);
  touched_.push_back(node);
  const Eigen::Index needed = 3 * (added + 1);
  if (C_.rows() < needed) C_.conservativeResize(needed + needed / 2, needed + needed / 2);
  solveForNode(row);
  const auto& place = factor_.permutationP().indices();
  for (Eigen::Index b = 0; b <= added; ++b) {
    const int first = system_.firstRow(touched_[b]);
    Matrix3 block;
    for (int i = 0; i < 3; ++i) block.row(i) = columns_.row(place[first + i]);
    C_.block<3, 3>(3 * b, 3 * added) = block;
    C_.block<3, 3>(3 * added, 3 * b) = block.transpose();
  }
  return index_of_[node];
}

/// columns_ = (P^-1)'s three columns of a node, in the factor's order. The three together read the factor once, not thrice.
void FactoredBody::solveForNode(int row) {
  const auto& L = factor_.matrixL().nestedExpression();  // of each column the diagonal first
  const int* const start = L.outerIndexPtr();
  const int* const rows = L.innerIndexPtr();
  const double* const values = L.valuePtr();
  columns_.setZero(system_.size(), 3);
  int first = static_cast<int>(system_.size());
  for (int axis = 0; axis < 3; ++axis) {
    const int at = factor_.permutationP().indices()[row + axis];
    columns_(at, axis) = 1.0;
    first = std::min(first, at);
  }
  for (int j = first; j < system_.size(); ++j) {
    const Eigen::RowVector3d x = columns_.row(j) / values[start[j]];
    columns_.row(j) = x;
    if (x.isZero(0.0)) continue;
    for (int k = start[j] + 1; k < start[j + 1]; ++k) columns_.row(rows[k]) -= values[k] * x;
  }
  for (int j = static_cast<int>(system_.size()) - 1; j >= 0; --j) {
    Eigen::RowVector3d x = columns_.row(j);
    for (int k = start[j] + 1; k < start[j + 1]; ++k) x -= values[k] * columns_.row(rows[k]);
    columns_.row(j) = x / values[start[j]];
  }
}

void FactoredBody::gatherTouched(const NodalVectors& v, VectorX& velocities) const {
  velocities.resize(3 * static_cast<Eigen::Index>(touched_.size()));
  for (std::size_t s = 0; s < touched_.size(); ++s) {
    velocities.segment<3>(3 * static_cast<Eigen::Index>(s)) = v.col(touched_[s]);
  }
}

void FactoredBody::addResponse(int touched, const Vector3& impulse_W, VectorX& velocities) const {
  const Eigen::Index rows = velocities.size();
  for (int axis = 0; axis < 3; ++axis)
    velocities += impulse_W[axis] * C_.col(3 * static_cast<Eigen::Index>(touched) + axis).head(rows);
}

}  // namespace tissue_contact
