/// @file
/// Room `tissue`: tetrahedral meshes: generated or read, checked, with their boundary surface and fixed nodes.
#pragma once

#include <string>
#include <vector>

#include "tissue_contact/core/types.h"
#include "tissue_contact/scene/scene.h"

namespace tissue_contact {

struct TetMesh {
  NodalVectors positions;  ///< m, tissue frame T
  std::vector<Tetrahedron> tetrahedra;
};

/// Structured block: (cells+1) nodes per axis, x fastest; 5 tetrahedra per cell, mirrored in every other cell so that
/// faces match and no direction is preferred; spacing graded as described. @throws std::invalid_argument for bad sizes.
TetMesh makeBlockMesh(const BlockDescription& block);

/// Reads Gmsh .msh (2.x, 4.0, 4.1; ASCII and binary) or legacy VTK (ASCII and binary). Elements other than tetrahedra
/// are ignored. Coordinates are multiplied by the scale. Node and element order is the file's.
/// @throws std::invalid_argument naming file and line or byte: truncated, counts that do not fit the file, unknown format.
TetMesh loadTetMesh(const MeshDescription& description);

/// Refuses what the elasticity cannot use. @throws std::invalid_argument naming `source` and the 0-based index: no
/// tetrahedra, non-finite node, node index out of range, inverted or zero-volume element, two elements with the same four
/// nodes, a node that no element uses.
void checkTetMesh(const TetMesh& mesh, const std::string& source);

/// Signed volume (m^3) of a tetrahedron.
double signedVolume(const NodalVectors& x, const Tetrahedron& tet);

/// Faces that belong to one tetrahedron only, outward, in the order of their tetrahedra.
/// @throws std::invalid_argument when a face belongs to more than two tetrahedra.
std::vector<Triangle> boundaryTriangles(const std::vector<Tetrahedron>& tetrahedra);

/// For each node whether any of the regions holds it. @throws std::invalid_argument when a region holds no node.
std::vector<bool> fixedNodes(const NodalVectors& positions, const std::vector<FixedRegion>& regions,
                             const std::string& source);

}  // namespace tissue_contact
