/// @file
/// Room `contact`, private: from the triangles of a mesh to a sampled signed distance (start-up only).
#pragma once

#include <array>
#include <functional>

#include "contact/shape/distance_grid.h"
#include "mesh/surface/winding_tree.h"

namespace tissue_contact {

/// Spacing and place of a grid around a mesh.
struct GridPlan {
  static constexpr int kBlock = 4;  ///< samples
  Vector3 origin;                   ///< of the first sample, m
  double spacing = 0.0;             ///< m
  std::array<int, 3> blocks{};      ///< of kBlock samples along each axis
};

/// Edges of the box around vertices, m, with room for the contacts of the next step; beyond it distances are lower bounds.
Vector3 paddedExtent(const NodalVectors& vertices);

/// @param sample_count about how many samples the grid may have; it may get some tenths more.
GridPlan planGrid(const TriangleMesh& mesh, double sample_count);

/// Inside is where `all` winds around a point (WindingTree::isInside): small holes, several shells, inner faces and
/// reversed parts do not matter. Samples farther than some spacings from the surface are interpolated
/// from every fourth. On up to four threads, with the same bits on any number.
/// @param all every triangle.
/// @param outer those from which distance is measured.
/// @param progress share done; may be empty.
DistanceGrid sampleDistance(const WindingTree& all, const TriangleTree& outer, const GridPlan& plan,
                            const std::function<void(double share)>& progress);

}  // namespace tissue_contact
