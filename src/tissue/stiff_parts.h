/// @file
/// Room `tissue`, private: parts of a volume that are far stiffer than most of it, such as a tumour or a vessel, for solvers that move each
/// as one.
#pragma once

#include <vector>

#include "tissue_contact/core/types.h"
#include "tissue_contact/mesh/tet_mesh.h"
#include "tissue_contact/tissue/element_materials.h"

namespace tissue_contact {

/// How many times the shear modulus that half of the volume does not exceed makes an element stiff (doc/method.md).
constexpr double kStiffRatio = 4.0;

/// @param x where the nodes are at rest, m.
/// @return nodes of the stiff elements that shared nodes connect, ascending; parts in order of their first node.
std::vector<std::vector<int>> findStiffParts(const NodalVectors& x, const std::vector<Tetrahedron>& tetrahedra,
                                             const ElementMaterials& materials);

}  // namespace tissue_contact
