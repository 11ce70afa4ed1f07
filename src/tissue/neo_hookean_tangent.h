/// @file
/// Room `tissue`, private: an element's share of the neo-Hookean stiffness: the second derivative of the energy of neo_hookean.h with
/// its negative eigenvalues set to zero. Deformation gradients in; 3 x 3 blocks per pair of nodes out.
///
/// In the frames U, V of F = U diag(sigma) V' the derivative falls apart: with X = U' dF V, dP = U Y V',
///   Y_ii = sum_l stretch_il X_ll   and, for i != j,   Y_ij = direct_ij X_ij + crossed_ij X_ji,
/// so that three pairs and one symmetric 3 x 3 matrix are left to be made positive (Smith, de Goes, Kim 2018, section 4).
#pragma once

#include <Eigen/Core>
#include <array>

#include "tissue/lanes.h"
#include "tissue/neo_hookean_kernel.h"
#include "tissue_contact/core/types.h"
#include "tissue_contact/tissue/element_materials.h"

namespace tissue_contact {

/// What a patch adds to its elements.
struct InPatch {
  double pressure = 0.0;      ///< to the factor of dJ/dF, Pa
  double flat_modulus = 0.0;  ///< where J is below kFlat, Pa; 0: no patch
};

/// What the stiffness of an element is made from.
struct TangentPoint {
  Matrix3 F;
  LameParameters material;  ///< lambda and mu of the model, Pa
  InPatch patch;
};

constexpr std::size_t kTangentBlocks = 10;
/// Of nodes (n, m), n <= m: (0, 0), (0, 1), ... (3, 3).
using TangentBlocks = std::array<Matrix3, kTangentBlocks>;

/// The simple version: one element, singular values from a polar decomposition and a 3 x 3 eigenproblem; good for any F.
/// @param gradients of the four shape functions, columns, 1/m.
/// @return blocks in N/m.
TangentBlocks tangentBlocks(const TangentPoint& point, const Eigen::Matrix<double, 3, 4>& gradients, double volume_m3);

/// Four elements side by side, whatever their places in the mesh.
struct TangentLanes {
  MatrixBatch F;
  MatrixBatch rest_inverse;  ///< as ElementBatch's, 1/m
  ElementValues volume;      ///< m^3; negative: to be taken out of a sum
  ElementValues lambda, mu, pressure, flat_modulus;
  std::array<MatrixBatch, kTangentBlocks> blocks;  ///< out, N/m
};

/// The fast version: computes `blocks`, by Jacobi rotations of F'F. What a lane gets does not depend on the others.
/// @return a bit for each lane whose F is too near to a line or a point, or too large for its powers: its blocks mean nothing.
unsigned char computeTangents(TangentLanes& lanes);

}  // namespace tissue_contact
