/// @file
/// Room `mesh`, private: a closed surface in, tetrahedra out, by the program gmsh. It is under the GPL: run, never linked.
#pragma once

#include <string>

#include "mesh/mesh_quality.h"
#include "tissue_contact/mesh/tet_mesh.h"
#include "tissue_contact/mesh/triangle_mesh.h"

namespace tissue_contact {

/// What gmsh is asked for; changes of it make other meshes.
struct FillOptions {
  double cell_m = 0.0;         ///< edge of the cells at the surface
  double inside_cell_m = 0.0;  ///< and deep inside; not below the other
};

/// The text of gmsh's instructions: the surface is cut into patches at edges sharper than `edge_angle` (degrees), which are flattened,
/// meshed anew with triangles of the asked size, and filled.
std::string gmshScript(const FillOptions& options, double edge_angle);

struct GmshResult {
  std::string file;       ///< content of the .msh, m; empty: it failed
  std::string complaint;  ///< what gmsh said then
  bool timed_out = false;
  TetMesh mesh;
  MeshQuality quality;
};

/// The better of what gmsh makes with sharp edges kept and without. One thread and fixed algorithms: the same bytes every time.
GmshResult fillWithGmsh(const TriangleMesh& surface, const FillOptions& options);

}  // namespace tissue_contact
