/// @file
/// Room `mesh`, private: the part of a mesh that bounds its solid.
#pragma once

#include <cstddef>
#include <functional>

#include "mesh/surface/winding_tree.h"

namespace tissue_contact {

/// Triangles without those, and the parts of those, that have the inside on both sides: inner faces, and where shells
/// overlap. What is cut is cut to pieces of about `finest`, m. Takes bounded time: when a mesh that passes through itself all over has
/// taken half a minute, the triangles that are left stay as they are.
/// @param progress share done, before each triangle; may be empty.
/// @param left number of triangles that stayed as they are, if not null.
TriangleMesh outerSurface(const TriangleMesh& mesh, const WindingTree& tree, double finest,
                          const std::function<void(double share)>& progress = {}, std::size_t* left = nullptr);

}  // namespace tissue_contact
