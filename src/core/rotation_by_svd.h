/// @file
/// Room `core`, private: the rotation in a matrix.
#pragma once

#include <Eigen/SVD>

#include "tissue_contact/core/types.h"

namespace tissue_contact {

/// The rotation nearest to a matrix (least Frobenius norm of the difference), without mirroring: of a deformation gradient its rotation, of a sum
/// of rotations their mean.
inline Matrix3 rotationBySvd(const Matrix3& matrix) {
  const Eigen::JacobiSVD<Matrix3> svd(matrix, Eigen::ComputeFullU | Eigen::ComputeFullV);
  Matrix3 U = svd.matrixU();
  if ((U * svd.matrixV().transpose()).determinant() < 0.0) U.col(2) = -U.col(2);
  return U * svd.matrixV().transpose();
}

}  // namespace tissue_contact
