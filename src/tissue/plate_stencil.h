/// @file
/// Room `tissue`, private: how a triangle mesh measures its curvature. Rest geometry in; per triangle the curvature
/// tensor as a linear function of the fold of the edges around it out.
///
/// The fold of an inner edge (hinge) is the jump of the deflection's slope across it, or the angle between its
/// triangles.
/// 1. Each triangle fits a quadratic to itself and its neighbours (unfolded into its plane): with three neighbours the
///    one through their six nodes, at a free border the one of least bending energy.
/// 2. The slope across an edge, at its middle, is the mean of what the fits of its two triangles say.
/// 3. A triangle's curvature is the mean gradient of the slope, by the divergence theorem over its border:
///    kappa = 1/A sum_k l_k m_k m_k' s_k, s_k the slope across edge k relative to the triangle's own.
/// Step 1 makes any quadratic surface exact on any mesh, step 2 makes neighbours agree on the slope between them, so
/// that bending moments balance; folds taken one by one, as in most cloth models, have neither, and how stiff
/// they are depends on the mesh.
/// Source: the rotation-free shell triangle EBST of Flores and Onate, "Improvements in the membrane behaviour of the
/// three node rotation-free BST shell triangle using an assumed strain approach", CMAME 194, 2005, for bending
/// alone; the treatment of free borders is our own.
#pragma once

#include <array>
#include <vector>

#include "tissue_contact/core/types.h"

namespace tissue_contact {

/// An inner edge (a, b) and the nodes c and d opposite to it; a to b runs as in the triangle of c.
struct Hinge {
  std::array<int, 4> nodes;    ///< a, b, c, d
  std::array<double, 4> jump;  ///< slope jump = sum jump_i z_i of out-of-plane positions, 1/m; unfolded rest shape
};

/// Curvature (xx, yy, 2 xy in the triangle's frame, 1/m) = sum over hinges of column * fold.
struct CurvatureStencil {
  static constexpr int kMaxHinges = 9;
  int count = 0;
  std::array<int, kMaxHinges> hinges;
  Eigen::Matrix<double, 3, kMaxHinges> columns;
};

struct PlateStencils {
  std::vector<Hinge> hinges;
  std::vector<CurvatureStencil> triangles;
};

/// @param triangles checked by checkSheetMesh.
/// @param poissons_ratio per triangle; it matters at free borders.
PlateStencils makePlateStencils(const NodalVectors& rest, const std::vector<Triangle>& triangles,
                                const std::vector<double>& poissons_ratio);

/// Energy of a plate of unit bending stiffness per area is 1/2 kappa' M kappa.
Matrix3 plateTensor(double poissons_ratio);

}  // namespace tissue_contact
