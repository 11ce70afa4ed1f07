/// @file
/// Room `tissue`, private: what a turn of an element changes in its stiffness.
#pragma once

#include "tissue_contact/core/types.h"

namespace tissue_contact {

/// A shape function's gradient, turned, and 0: columns of four are whole registers.
using PaddedGradient = Eigen::Vector4d;

inline PaddedGradient turnedGradient(const Matrix3& R, const Vector3& gradient) {
  PaddedGradient turned;
  turned << R * gradient, 0.0;
  return turned;
}

/// lambda a_i a_j' + mu a_j a_i', less the same of b: block (i, j) of the stiffness with gradients a in the place of b. The last term of a
/// block, mu (a_i . a_j) I, is the same for both.
inline Matrix3 turnedBlock(double lambda, double mu, const PaddedGradient& a_i, const PaddedGradient& a_j,
                           const PaddedGradient& b_i, const PaddedGradient& b_j) {
  const PaddedGradient lambda_a = lambda * a_i, mu_a = mu * a_j;
  const PaddedGradient lambda_b = lambda * b_i, mu_b = mu * b_j;
  Eigen::Matrix<double, 4, 3> block;
  for (int c = 0; c < 3; ++c) {
    block.col(c) = (lambda_a * a_j[c] + mu_a * a_i[c]) - (lambda_b * b_j[c] + mu_b * b_i[c]);
  }
  return block.topRows<3>();
}

}  // namespace tissue_contact
