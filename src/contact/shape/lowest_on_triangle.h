/// @file
/// Room `contact`, private: where on a triangle a sampled distance is least.
#pragma once

#include "contact/shape/distance_grid.h"
#include "contact/shape/shape_distance.h"

namespace tissue_contact {

/// Local optimisation of a distance field over a triangle (Macklin et al. 2020), started where it can be lowest: the
/// triangle is cut in four again and again, pieces first whose lower bound (the distance changes no faster than the way)
/// is least; from the lowest point met, cutting planes inside a trust region. The field need not be convex.
/// @param margin gives up once the distance is certainly more than this, m.
/// @return false when it is. `result.gradients` are those of the planes that meet at the point.
bool lowestOnTriangle(const DistanceGrid& grid, const TrianglePoints& triangle, double margin, ClosestPoint& result);

}  // namespace tissue_contact
