/// @file
/// Room `instrument`: collision shapes with their meshes read, ready for contact detection.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "tissue_contact/core/types.h"
#include "tissue_contact/scene/scene.h"

namespace tissue_contact {

/// A triangle surface, vertices in the shape's frame S (m, scale applied), coincident vertices merged so that triangles
/// share them, outward orientation (positive enclosed volume) when it is closed.
struct TriangleMesh {
  NodalVectors vertices;
  std::vector<Triangle> triangles;
};

/// Reads STL, OBJ or DAE (assimp), applies the node transforms and then `scale`, merges coincident vertices, drops
/// degenerate triangles. DAE as in RViz: its <unit> is applied, its <up_axis> is not. Files up to 64 MB. Reading
/// happens in a child process, because assimp crashes on some malformed files: call it at start-up, not in a step.
/// @throws std::invalid_argument naming the file: unreadable, no triangles, non-finite vertices, a zero scale.
TriangleMesh loadTriangleMesh(const std::string& file, const Vector3& scale);

struct CollisionShape {
  ShapeGeometry geometry;
  Pose X_LS = Pose::Identity();
  std::shared_ptr<const TriangleMesh> mesh;  ///< set exactly when `geometry` holds a MeshGeometry
};

/// Completes a description: checks sizes and reads the mesh if there is one. A mesh must be a solid: small holes are
/// accepted; a sheet, of which nothing tells the inside, is refused. @throws std::invalid_argument.
CollisionShape makeCollisionShape(const ShapeDescription& description);

}  // namespace tissue_contact
