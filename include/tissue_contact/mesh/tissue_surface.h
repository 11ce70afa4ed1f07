/// @file
/// Room `mesh`: surfaces of tissues, for what detects contacts on them.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "tissue_contact/core/types.h"

namespace tissue_contact {

/// Surface of one tissue: triangles over its nodes.
struct TissueSurface {
  std::vector<Triangle> triangles;
  std::vector<bool> fixed;  ///< per node; points of which they make up more than three quarters are no contacts
  /// > 0: an open sheet, touched from both sides, half the thickness before its triangles. 0: the boundary of a volume.
  double thickness_m = 0.0;
};

class MovingSurface;

/// The surfaces of all tissues of a scene. What detects contacts on them shares them, so that each follows its nodes once
/// per step.
using SharedSurfaces = std::shared_ptr<std::vector<MovingSurface>>;

/// @param surfaces one per tissue.
/// @param rest positions at rest, one per tissue, m, world frame.
/// @throws std::invalid_argument when the sizes differ, a triangle refers to a missing node or twice to the same, or a
///   thickness is not finite or < 0.
SharedSurfaces shareSurfaces(std::vector<TissueSurface> surfaces, const std::vector<NodalVectors>& rest);

/// Of the edges of triangles, each counted once however many triangles share it.
struct EdgeLengths {
  double sum_m = 0.0;
  std::size_t count = 0;
};
EdgeLengths edgeLengths(const NodalVectors& x, const std::vector<Triangle>& triangles);

/// Point of a triangle, m.
/// @param weights barycentric.
inline Vector3 pointOf(const NodalVectors& x, const Triangle& nodes, const Vector3& weights) {
  return weights[0] * x.col(nodes[0]) + weights[1] * x.col(nodes[1]) + weights[2] * x.col(nodes[2]);
}

}  // namespace tissue_contact
