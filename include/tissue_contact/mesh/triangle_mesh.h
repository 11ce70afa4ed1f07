/// @file
/// Room `mesh`: triangle meshes, of shapes and of membranes: generated or read, and checked.
#pragma once

#include <string>
#include <vector>

#include "tissue_contact/core/types.h"
#include "tissue_contact/mesh/mesh_description.h"

namespace tissue_contact {

struct TriangleMesh {
  NodalVectors vertices;  ///< m, in the shape's frame S, or the tissue frame T of a membrane
  std::vector<Triangle> triangles;
};

/// Reads STL, OBJ or DAE (assimp), applies the node transforms and then `scale`, merges coincident vertices so that
/// triangles share them, drops degenerate triangles, and turns closed parts outward (positive enclosed volume). DAE as in
/// RViz: its <unit> is applied, its <up_axis> is not. Files up to 64 MB. Reading happens in a child process, because
/// assimp crashes on some malformed files: call it at start-up, not in a step.
/// @throws std::invalid_argument naming the file: unreadable, no triangles, non-finite vertices, a zero scale.
TriangleMesh loadTriangleMesh(const std::string& file, const Vector3& scale);

/// Reads the mesh of a membrane.
/// @throws std::invalid_argument naming the file.
TriangleMesh loadShellMesh(const ShellDescription& shell);

/// Flat grid at z = 0: (cells+1) nodes per axis, x fastest; 2 triangles per cell, counter-clockwise seen from +z, the
/// diagonal turned in every other cell so that no direction is preferred. The outer nodes lie exactly on the edges.
/// @throws std::invalid_argument for a size out of range or more than a million cells.
TriangleMesh makeSheetMesh(const SheetDescription& sheet);

/// Refuses what a membrane cannot use.
/// @throws std::invalid_argument naming `source` and the 0-based index: no triangles, non-finite node, node index out
///   of range, triangle without area (at most 1e-10 of its longest edge squared), two triangles with the same nodes, an
///   edge of more than two triangles, neighbours wound against each other (their normals on opposite sides), a node
///   that no triangle uses.
void checkSheetMesh(const TriangleMesh& mesh, const std::string& source);

/// Area (m^2) of a triangle.
double triangleArea(const NodalVectors& x, const Triangle& triangle);

}  // namespace tissue_contact
