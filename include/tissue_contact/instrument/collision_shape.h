/// @file
/// Room `instrument`: collision shapes with their meshes read, ready for contact detection.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "tissue_contact/core/types.h"
#include "tissue_contact/instrument/instrument_description.h"
#include "tissue_contact/mesh/triangle_mesh.h"

namespace tissue_contact {

struct CollisionShape {
  ShapeGeometry geometry;
  Pose X_LS = Pose::Identity();
  std::shared_ptr<const TriangleMesh> mesh;  ///< set exactly when `geometry` holds a MeshGeometry
};

/// Completes a description: checks sizes and reads the mesh if there is one. A mesh must be a solid: small holes are
/// accepted; a sheet, of which nothing tells the inside, is refused.
/// @throws std::invalid_argument.
CollisionShape makeCollisionShape(const ShapeDescription& description);

}  // namespace tissue_contact
