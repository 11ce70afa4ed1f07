/// @file
/// Room `contact`, private: from the triangles of a mesh to a sampled signed distance (start-up only).
#pragma once

#include "contact/distance_grid.h"
#include "contact/surface_tree.h"

namespace tissue_contact {

/// Spacing and position of a grid around a mesh; no samples yet.
struct GridPlan {
  Vector3 origin;
  double spacing;              ///< m
  std::array<int, 3> blocks;   ///< of kBlock samples along each axis
  static constexpr int kBlock = 4;
};
GridPlan planGrid(const TriangleMesh& mesh, double spacing, double padding);

/// Inside is where the surface winds around a point more than half a time. Samples farther from the surface than some
/// spacings are interpolated from every fourth.
DistanceGrid sampleDistance(const SurfaceTree& tree, const GridPlan& plan);

}  // namespace tissue_contact
