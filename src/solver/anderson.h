/// @file
/// Room `solver`, private: Anderson's acceleration of a fixed-point iteration x -> g(x). Pairs (x, g(x)) in; the next x
/// out.
#pragma once

#include <Eigen/Core>

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

  /// Allocates only when x has another size than at the restart before. Between restarts it keeps its size.
  /// @param x where the map was evaluated.
  /// @param g what it gave.
  /// @return where to go on, valid until the next call; g itself at first and after the residual has grown.
  const VectorX& next(const VectorX& x, const VectorX& g);

  /// Begins anew, with another map.
  void restart() { steps_ = 0; }

 private:
  using Products = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, kMostSteps, kMostSteps>;
  using Weights = Eigen::Matrix<double, Eigen::Dynamic, 1, Eigen::ColMajor, kMostSteps, 1>;

  void remember(const VectorX& g);
  void mix(int known);

  int depth_;
  int steps_ = 0;                     ///< since they were forgotten
  double least_ = 0.0;                ///< smallest residual since then
  Eigen::MatrixXd residual_changes_;  ///< ring of `depth` columns
  Eigen::MatrixXd g_changes_;
  Products products_;  ///< of each two columns of residual_changes_
  VectorX residual_;   ///< g - x
  VectorX last_residual_;
  VectorX last_g_;
  VectorX next_;
};

}  // namespace tissue_contact
