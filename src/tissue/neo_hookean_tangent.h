/// @file
/// Room `tissue`, private: an element's share of the neo-Hookean stiffness, whatever the number of its nodes: the second derivative of the
/// energy of neo_hookean.h with its negative eigenvalues made positive. Deformation gradients in; 3 x 3 blocks per pair of nodes out.
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

/// What the stiffness of an element, or of a patch that is one, is made from.
struct TangentPoint {
  Matrix3 F;
  LameParameters material;  ///< lambda and mu of the model, Pa
  InPatch patch;
};

/// The simple version: singular values from a polar decomposition and a 3 x 3 eigenproblem; good for any F.
class Tangent {
 public:
  explicit Tangent(const TangentPoint& point);

  /// Of two nodes whose shape functions have these gradients, 1/m: their block of the stiffness per volume, N/m^4.
  Matrix3 block(const Vector3& gradient_n, const Vector3& gradient_m) const;

 private:
  Matrix3 U_, V_;
  Matrix3 stretch_;
  Matrix3 direct_, crossed_;  ///< symmetric, diagonals unused
};

/// Four elements or patches side by side, whatever their places in the mesh.
struct TangentLanes {
  MatrixBatch F;
  ElementValues volume;  ///< m^3; negative: to be taken out of a sum
  ElementValues lambda, mu, pressure, flat_modulus;
};

/// The gradient of a node's shape function in each of four elements or patches, 1/m.
using GradientLanes = std::array<ElementValues, 3>;

/// The fast version, by Jacobi rotations of F'F. What a lane gets does not depend on the others.
/// @param gradients of `count` nodes. @param turned scratch, as many.
/// @param blocks of the pairs of nodes n <= m, row by row, N/m.
/// @return a bit for each lane whose F is too near to a line or a point, or too large for its powers: its blocks mean nothing.
unsigned char computeTangents(const TangentLanes& lanes, const GradientLanes* gradients, std::size_t count,
                              GradientLanes* turned, MatrixBatch* blocks);

}  // namespace tissue_contact
