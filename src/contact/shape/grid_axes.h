/// @file
/// Room `contact`, private: how the grid of a sampled distance lies in a mesh (start-up only).
#pragma once

#include "tissue_contact/mesh/triangle_mesh.h"

namespace tissue_contact {

/// Axes, as columns, along which the grid around a mesh is small and its samples so near to each other: of boxes around
/// the mesh one whose volume is least when it is turned about one of its axes at a time, starting from the file's axes and
/// from the principal axes of the surface (area-weighted second moments). How a mesh lies in its file matters little then:
/// along the file's axes a shaft of 8 x 410 mm that lies across them has samples 3.4 mm apart, along its own 0.46 mm.
/// Identity unless that saves a quarter of the volume, so that most meshes are sampled along their file's axes.
/// @param mesh at least one triangle.
Matrix3 gridAxes(const TriangleMesh& mesh);

}  // namespace tissue_contact
