/// @file
/// Room `solver`, private: Anderson's acceleration of a fixed-point iteration x -> g(x). Pairs (x, g(x)) in; the next x
/// out.
#pragma once

#include <Eigen/Core>
#include <vector>

#include "tissue_contact/core/types.h"

namespace tissue_contact {

/// The combination of the last steps whose mixed residual g(x) - x is smallest (Walker & Ni 2011, type II). Forgets its
/// steps when the residual grows, because then another piece of the map is reached where they mean nothing.
///
/// The weights come from the normal equations, cheap beside one evaluation of the map. What these lose in accuracy is
/// lost in the choice of the next x alone: a fixed point stays one, whatever the weights.
class AndersonMixing {
 public:
  static constexpr int kMostSteps = 10;

  /// @param depth steps that are mixed, 1 to kMostSteps.
  explicit AndersonMixing(int depth);

  using View = Eigen::Map<VectorX>;

  /// Allocates only when x is larger than ever before. Between restarts it keeps its size.
  /// @param x where the map was evaluated.
  /// @param g what it gave.
  /// @return where to go on, valid until the next call; g itself at first and after the residual has grown.
  View next(const Eigen::Ref<const VectorX>& x, const Eigen::Ref<const VectorX>& g);

  /// Begins anew, with another map.
  void restart() { steps_ = 0; }

 private:
  using Products = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, kMostSteps, kMostSteps>;
  using Weights = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, kMostSteps, 1>;

  void resize(Eigen::Index size);
  void remember(const Eigen::Ref<const VectorX>& g);
  void mix(int known, View& next);

  View vector(int k) { return {store_.data() + k * size_, size_}; }
  View residualChange(int k) { return vector(k); }  ///< rings of `depth`
  View gChange(int k) { return vector(depth_ + k); }
  View residual() { return vector(2 * depth_); }  ///< g - x
  View lastResidual() { return vector(2 * depth_ + 1); }
  View lastG() { return vector(2 * depth_ + 2); }

  int depth_;
  int steps_ = 0;              ///< since they were forgotten
  double least_ = 0.0;         ///< smallest residual since then
  Products products_;          ///< of each two changes of the residual
  std::vector<double> store_;  ///< all vectors, one after the other: a matrix gives memory back when it shrinks
  Eigen::Index size_ = 0;      ///< of x
};

}  // namespace tissue_contact
