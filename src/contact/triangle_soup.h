/// @file
/// Room `contact`, private: triangles that share no vertices.
#pragma once

#include <vector>

#include "tissue_contact/instrument/collision_shape.h"

namespace tissue_contact {

/// @param points three per triangle, in its order; what is left over is no triangle's.
TriangleMesh triangleSoup(const std::vector<Vector3>& points);

}  // namespace tissue_contact
