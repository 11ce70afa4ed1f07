/// @file
/// Room `solver`, private: Anderson's acceleration of a fixed-point iteration x -> g(x). Pairs (x, g(x)) in; the next x
/// out.
#pragma once

#include <Eigen/Core>

#include "tissue_contact/core/types.h"

namespace tissue_contact {

/// The combination of the last steps whose mixed residual g(x) - x is smallest (Walker & Ni 2011, type II). Forgets its
/// steps when the residual grows, because then another piece of the map is reached where they mean nothing.
class AndersonMixing {
 public:
  explicit AndersonMixing(int depth) : depth_(depth) {}

  /// @param x where the map was evaluated. @param g what it gave. @return where to go on; g itself after a restart.
  VectorX next(const VectorX& x, const VectorX& g);

 private:
  int depth_;
  int steps_ = 0;                     ///< since the last restart
  double least_ = 0.0;                ///< smallest residual since the last restart
  Eigen::MatrixXd residual_changes_;  ///< ring of `depth` columns
  Eigen::MatrixXd g_changes_;
  VectorX residual_;
  VectorX g_;
};

}  // namespace tissue_contact
