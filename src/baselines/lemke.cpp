#include "baselines/lemke.h"

#include <algorithm>

namespace tissue_contact {
namespace {

/// Basic variables as functions of the others: x_row(i) = constant_i + sum_j T(i, j) x_column(j). Variables are
/// numbered w_0 .. w_n-1, z_0 .. z_n-1 and the artificial z0 = 2 n.
class Dictionary {
 public:
  Dictionary(const Eigen::Ref<Eigen::MatrixXd>& tableau, const Eigen::Ref<Eigen::VectorXi>& labels)
      : n_(static_cast<int>(tableau.rows())), T_(tableau), labels_(labels) {
    for (int i = 0; i < n_; ++i) {
      labels_[i] = i;
      labels_[n_ + i] = n_ + i;
    }
    labels_[artificial()] = artificial();
    T_.col(n_).setOnes();
  }

  int artificial() const { return 2 * n_; }
  int complement(int variable) const { return variable < n_ ? variable + n_ : variable - n_; }
  int rowVariable(int row) const { return labels_[row]; }
  double value(int row) const { return T_(row, n_ + 1); }

  int columnOf(int variable) const {
    for (int j = 0; j <= n_; ++j) {
      if (labels_[n_ + j] == variable) return j;
    }
    return -1;
  }

  /// The row that must leave first when z0 enters: most negative constant, the last of equals (lexicographic).
  int firstRow() const {
    int row = 0;
    for (int i = 1; i < n_; ++i) {
      if (value(i) <= value(row)) row = i;
    }
    return row;
  }

  /// The row whose variable reaches 0 first as `column` grows; -1 if none does.
  int leavingRow(int column) const {
    constexpr double kPivot = 1e-11;  // of entries about 1: round-off of a few hundred updates
    constexpr double kTie = 1e-13;
    int best = -1;
    double best_ratio = 0.0;
    for (int i = 0; i < n_; ++i) {
      const double slope = -T_(i, column);
      if (!(slope > kPivot)) continue;
      const double ratio = std::max(value(i), 0.0) / slope;
      const double tie = kTie * (1.0 + std::abs(best_ratio));
      const bool tied = best >= 0 && std::abs(ratio - best_ratio) <= tie;
      if (best >= 0 && !tied && ratio > best_ratio) continue;
      if (tied && !winsTie(i, best, column)) continue;
      best = i;
      best_ratio = ratio;
    }
    return best;
  }

  void pivot(int row, int column) {
    const double inverse = 1.0 / T_(row, column);
    for (int j = 0; j < n_ + 2; ++j) {
      const double factor = -T_(row, j) * inverse;
      if (j == column || factor == 0.0) continue;
      T_.col(j) += factor * T_.col(column);
      T_(row, j) = factor;
    }
    T_.col(column) *= inverse;
    T_(row, column) = inverse;
    std::swap(labels_[row], labels_[n_ + column]);
  }

 private:
  /// Whether `row` comes before `other` at equal ratios: z0 always leaves if it can, else lexicographic order of the
  /// rows of the inverse basis, whose columns are those of the w.
  bool winsTie(int row, int other, int column) const {
    if (rowVariable(other) == artificial()) return false;
    if (rowVariable(row) == artificial()) return true;
    for (int w = 0; w < n_; ++w) {
      const double difference = inverseBasis(row, w) / -T_(row, column) - inverseBasis(other, w) / -T_(other, column);
      if (difference != 0.0) return difference < 0.0;
    }
    return false;
  }

  double inverseBasis(int row, int w) const {
    const int column = columnOf(w);
    if (column >= 0) return -T_(row, column);
    return rowVariable(row) == w ? 1.0 : 0.0;
  }

  int n_;
  Eigen::Ref<Eigen::MatrixXd> T_;
  Eigen::Ref<Eigen::VectorXi> labels_;
};

}  // namespace

LcpAnswer solveLcp(const Eigen::Ref<Eigen::MatrixXd>& tableau, const Eigen::Ref<Eigen::VectorXi>& labels,
                   Eigen::Ref<Eigen::VectorXd> z, int max_pivots) {
  const int n = static_cast<int>(tableau.rows());
  Dictionary dictionary(tableau, labels);
  LcpAnswer answer;
  z.setZero();
  int row = dictionary.firstRow();
  if (dictionary.value(row) >= 0.0) {
    answer.solved = true;
    return answer;
  }
  int column = n;
  while (row >= 0 && answer.pivots < max_pivots) {
    const int leaving = dictionary.rowVariable(row);
    dictionary.pivot(row, column);
    ++answer.pivots;
    if (leaving == dictionary.artificial()) {
      answer.solved = true;
      break;
    }
    column = dictionary.columnOf(dictionary.complement(leaving));
    row = dictionary.leavingRow(column);
  }
  for (int i = 0; i < n; ++i) {
    const int variable = dictionary.rowVariable(i);
    if (variable >= n && variable < 2 * n) z[variable - n] = std::max(dictionary.value(i), 0.0);
  }
  return answer;
}

}  // namespace tissue_contact
