/// @file
/// Room `contact`, private: the surface of a mesh shape as it acts, to be drawn.
#pragma once

#include "contact/shape/distance_grid.h"
#include "tissue_contact/mesh/triangle_mesh.h"

namespace tissue_contact {

/// Where the sampled distance is zero, by marching tetrahedra over cells as small as `most_triangles` allows. Outward.
TriangleMesh fieldSurface(const DistanceGrid& grid, std::size_t most_triangles);

}  // namespace tissue_contact
