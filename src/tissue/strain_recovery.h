/// @file
/// Room `tissue`, private: how far the strain of linear tetrahedra is from what a smoother field would be. A deformed tissue and a
/// part of it in; a share of that part's energy out.
#pragma once

#include <vector>

#include "tissue_contact/core/types.h"
#include "tissue_contact/tissue/tissue.h"

namespace tissue_contact {

/// Of the elements whose centroid at rest lies within `radius_m` of `center_W`:
///
///   sum_e mu int_e |E* - E_e|^2  /  sum_e mu V_e |E_e|^2,   E = dev (F'F - I) / 2,
///
/// E* being linear in each element, and at a node the mean of E over the elements around, by volume. It is 0 where the deformation is
/// affine, and of the second order in the size of the cells where it is smooth. Elements of different regions are not averaged with each
/// other, since strain jumps between materials. Changes of volume are left out: where they are averaged (MeanStrain), those of
/// single elements mean nothing. Source: Zienkiewicz & Zhu, IJNME 24 (1987) 337-357; Green's strain in place of the
/// infinitesimal one, which rotations would change.
/// @param shear_moduli Pa, of the tissue's material, then of its regions in their order.
/// @param x positions, m.
/// @return 0 where there are no tetrahedra or nothing is strained. Allocates.
double recoveredStrainError(const Tissue& tissue, const std::vector<double>& shear_moduli, const NodalVectors& x,
                            const Vector3& center_W, double radius_m);

}  // namespace tissue_contact
