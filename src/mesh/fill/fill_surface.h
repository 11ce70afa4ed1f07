/// @file
/// Room `mesh`, private: a surface file in, the tetrahedra that fill it out; kept on disk.
#pragma once

#include "tissue_contact/mesh/mesh_description.h"
#include "tissue_contact/mesh/mesh_preparation.h"
#include "tissue_contact/mesh/tet_mesh.h"

namespace tissue_contact {

/// Says what was made, how good it is and where it is kept: in the folder `meshes` of the cache, as a .msh in metres, under a hash of
/// the file's content, scale, cells and gmsh's version. A damaged file there is made again.
/// @param description with a cell_size_m.
/// @throws std::invalid_argument naming the file, what is wrong where, and the fix.
TetMesh fillSurface(const MeshDescription& description, const MeshPreparation& preparation);

}  // namespace tissue_contact
