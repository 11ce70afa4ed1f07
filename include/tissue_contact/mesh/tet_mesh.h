/// @file
/// Room `mesh`: tetrahedral meshes: generated or read, checked, with their boundary surface and fixed nodes.
#pragma once

#include <string>
#include <vector>

#include "tissue_contact/core/types.h"
#include "tissue_contact/mesh/mesh_description.h"
#include "tissue_contact/mesh/mesh_preparation.h"
#include "tissue_contact/mesh/region_description.h"

namespace tissue_contact {

struct MeshLabels;

struct TetMesh {
  NodalVectors positions;  ///< m, tissue frame T
  std::vector<Tetrahedron> tetrahedra;
};

/// Into how many tetrahedra a cell of a block is split. Six stay alike when their longest edges are cut (bisection.h); five
/// err less with as many nodes.
enum class BlockSplit { kFive = 5, kSix = 6 };

/// Structured block: (cells+1) nodes per axis, x fastest; 5 or 6 tetrahedra per cell, mirrored in every other cell so that
/// faces match and no direction is preferred; spacing graded as described. The outer nodes lie exactly on the faces,
/// and even or centred spacing is symmetric to the last bit. Tetrahedra come cell by cell.
/// @throws std::invalid_argument for a size or growth out of range, more than kMostElements, or growth that makes the
///   longest cell over 10 000 times the shortest.
TetMesh makeBlockMesh(const BlockDescription& block, BlockSplit split = BlockSplit::kFive);

/// What makeBlockMesh() would refuse. @throws EntryError of an entry of the block, "cells" or "grading.x.growth".
void checkBlock(const BlockDescription& block);

/// Of makeBlockMesh() where nothing else is said.
constexpr int kTetrahedraPerCell = 5;

/// Reads a tetrahedral mesh, or fills a surface (fill/fill_surface.h) where the description has a cell_size_m. Of the former:
/// Gmsh .msh (1, 2.x, 4.0, 4.1) or legacy VTK (1 to 5), ASCII and binary; the contents decide which, not the name.
/// Hexahedra, prisms and pyramids are split into tetrahedra, without new nodes; what has higher order is taken by its corners; tetrahedra
/// numbered the other way round are turned, a fold is refused; points, lines and surfaces are skipped, other cells refused. Coordinates are multiplied
/// by the scale. Node and element order is the file's; unreferenced nodes are dropped if the description says so, else
/// kept for checkTetMesh to name, and coincident ones treated as it says. The result has finite nodes, indices in range and a tetrahedron
/// at least: whether it is fit for elasticity, checkTetMesh tells. Memory follows the file's size (256 MB at most).
/// @param labels gets what a tetrahedral mesh file calls its parts (src/mesh/labels.h); null: that is not looked at.
/// @throws std::invalid_argument naming the file, the line (ASCII) or byte (binary) and the fix.
TetMesh loadTetMesh(const MeshDescription& description, const MeshPreparation& preparation = {},
                    MeshLabels* labels = nullptr);

/// Refuses what the elasticity cannot use.
/// @throws std::invalid_argument naming `source` and the 0-based index: no tetrahedra, non-finite node, node index out
///   of range, inverted or zero-volume element (volume at most 1e-12 of the element's longest edge cubed, whatever the
///   unit), two elements with the same four nodes, a node that no element uses.
void checkTetMesh(const TetMesh& mesh, const std::string& source);

/// D = [x1 - x0, x2 - x0, x3 - x0] of a tetrahedron, m.
inline Matrix3 edgeMatrix(const NodalVectors& x, const Tetrahedron& tet) {
  Matrix3 D;
  for (int i = 0; i < 3; ++i) D.col(i) = x.col(tet[i + 1]) - x.col(tet[0]);
  return D;
}

/// Signed volume (m^3) of a tetrahedron.
double signedVolume(const NodalVectors& x, const Tetrahedron& tet);

/// Faces that belong to one tetrahedron only, outward, in the order of their tetrahedra.
/// @throws std::invalid_argument when a face belongs to more than two tetrahedra.
std::vector<Triangle> boundaryTriangles(const std::vector<Tetrahedron>& tetrahedra);

/// For each node whether any of the regions holds it. Boundaries count as inside, and a node within 1e-9 of the
/// diagonal of the mesh's bounding box counts as on the boundary, since neither coordinates nor regions are free of
/// rounding.
/// @throws std::invalid_argument naming `source`, the region and the mesh's bounding box when a region holds no node.
std::vector<bool> fixedNodes(const NodalVectors& positions, const std::vector<Region>& regions,
                             const std::string& source);

}  // namespace tissue_contact
