/// @file
/// Room `tissue`, private: neighbouring tetrahedra in groups, over which their strain is averaged.
#pragma once

#include <vector>

#include "tissue_contact/core/types.h"

namespace tissue_contact {

/// Patch of every tetrahedron, numbered from 0 without gaps. Tetrahedra of a patch are connected through faces. Grown
/// element by element in an order that comes from where they are, x first: however a file lists its nodes and elements, the
/// patches are the same. A turned mesh may get others, so give positions in the mesh's own frame.
/// @param rest 3 x n, m.
///
/// Sizes: linear tetrahedra have 5 to 6 elements per node, so one constraint of volume per element asks for more than the
/// three coordinates of the node can give; patches of 5 leave about three coordinates per constraint, the ratio of the
/// continuum (Hughes, The Finite Element Method, 1987, section 4.3.7).
std::vector<int> patchesByFaces(const NodalVectors& rest, const std::vector<Tetrahedron>& tetrahedra);

/// Patches cut where elements are of different materials, so that a stiff one does not lend its bulk modulus to a soft one.
/// @param materials per tetrahedron; empty: one material.
std::vector<int> cutAtMaterials(const std::vector<int>& patch_of, const std::vector<int>& materials);

/// The same where tetrahedra come cell by cell, `cell_size` each.
std::vector<int> patchesByCells(std::size_t tetrahedra, int cell_size);

}  // namespace tissue_contact
