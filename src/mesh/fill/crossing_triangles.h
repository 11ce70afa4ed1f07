/// @file
/// Room `mesh`, private: where a surface passes through itself.
#pragma once

#include <cstddef>
#include <string>

#include "tissue_contact/core/types.h"
#include "tissue_contact/mesh/triangle_mesh.h"

namespace tissue_contact {

/// Pairs of triangles without a common vertex that cross each other.
struct Crossings {
  /// No more are counted: of thousands of parts that pass through each other all pairs cross.
  static constexpr std::size_t kMost = 10000;
  std::size_t count = 0;            ///< kMost + 1: more than kMost
  Vector3 place = Vector3::Zero();  ///< of the first, m
};
Crossings findCrossings(const TriangleMesh& mesh);

/// "it passes through itself; 12 pairs of triangles cross, the first at ...; repair it there ...".
std::string crossingText(const Crossings& crossings);

}  // namespace tissue_contact
