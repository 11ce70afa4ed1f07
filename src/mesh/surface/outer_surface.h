/// @file
/// Room `mesh`, private: the part of a mesh that bounds its solid.
#pragma once

#include "mesh/surface/winding_tree.h"

namespace tissue_contact {

/// Triangles without those, and the parts of those, that have the inside on both sides: inner faces, and where shells
/// overlap. What is cut is cut to pieces of about `finest`, m.
TriangleMesh outerSurface(const TriangleMesh& mesh, const WindingTree& tree, double finest);

}  // namespace tissue_contact
