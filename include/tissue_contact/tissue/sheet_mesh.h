/// @file
/// Room `tissue`: triangle meshes of membranes: generated or read, and checked.
#pragma once

#include <string>
#include <vector>

#include "tissue_contact/core/types.h"
#include "tissue_contact/scene/scene.h"

namespace tissue_contact {

struct SheetMesh {
  NodalVectors positions;  ///< m, tissue frame T
  std::vector<Triangle> triangles;
};

/// Flat grid at z = 0: (cells+1) nodes per axis, x fastest; 2 triangles per cell, counter-clockwise seen from +z, the
/// diagonal turned in every other cell so that no direction is preferred. The outer nodes lie exactly on the edges.
/// @throws std::invalid_argument for a size out of range or more than a million cells.
SheetMesh makeSheetMesh(const SheetDescription& sheet);

/// Reads STL, OBJ or DAE as the instrument's meshes are read (loadTriangleMesh: coincident vertices merged, triangles
/// without area dropped). @throws std::invalid_argument naming the file.
SheetMesh loadShellMesh(const ShellDescription& shell);

/// Refuses what a membrane cannot use. @throws std::invalid_argument naming `source` and the 0-based index: no
/// triangles, non-finite node, node index out of range, triangle without area (at most 1e-10 of its longest edge
/// squared), two triangles with the same nodes, an edge of more than two triangles, neighbours wound against each other
/// (their normals on opposite sides), a node that no triangle uses.
void checkSheetMesh(const SheetMesh& mesh, const std::string& source);

/// Area (m^2) of a triangle.
double triangleArea(const NodalVectors& x, const Triangle& triangle);

}  // namespace tissue_contact
