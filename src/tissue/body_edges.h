/// @file
/// Room `tissue`, private: how long edges of a volume's mesh may be wherever the tools are. A mesh that is to be refined in; its
/// lasting cuts out.
///
/// Meshes of organs that others made are often so coarse that a few nodes hold them where `fixed` says, that no element shows a tumour,
/// or that they bend much too stiffly far from any tool, however fine the cells under it (doc/notes/accuracy.md, "Coarse organs of others").
#pragma once

#include <vector>

#include "mesh/bisection.h"
#include "tissue_contact/mesh/tet_mesh.h"
#include "tissue_contact/tissue/tissue_description.h"

namespace tissue_contact {

/// The longest edge that elements may have where nothing touches, m: the diagonal of a cube of V^(1/3) / cells_across
/// (RefinementDescription::Choice).
double longestBodyEdge(const NodalVectors& rest, const std::vector<Tetrahedron>& tetrahedra,
                       const RefinementDescription& refinement);

/// Cuts the elements of a mesh from a file until none has a longer edge than that, and of any mesh those that the border of `fixed`, of an
/// attachment, of `pressure_where` or of a region runs through until none has one of half of it, or of the diagonal of a cube of
/// 1 / cells_across of a smaller region. Longer ones if that takes more than half of the nodes that may come: of small regions first,
/// then all alike.
/// @param tissue with groups and cell data as the places they are.
/// @return by what factor they are longer, at most: 1 or more.
double refineBody(const TetMesh& mesh, const TissueDescription& tissue, Bisection& bisection);

}  // namespace tissue_contact
