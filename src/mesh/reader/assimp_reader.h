/// @file
/// Room `mesh` (private): mesh file in, unconnected triangles out (assimp).
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tissue_contact/core/types.h"

namespace tissue_contact {

constexpr std::uintmax_t kMaxSurfaceBytes = 64u << 20;  ///< of a file: 1.3 million triangles of binary STL

struct TriangleSoup {
  std::vector<Vector3> vertices;    ///< in the file's units (DAE: m), node transforms applied, finite
  std::vector<Triangle> triangles;  ///< indices in range; winding as in the file, also under a mirroring transform
};

/// Reads all triangles of a file; polygons are cut into triangles, points and lines skipped. Runs assimp in a child
/// process (see isolated.h).
///
/// DAE, as RViz and geometric_shapes do it: the file's <unit> is applied, its <up_axis> is not, so the numbers in the
/// file are coordinates of the link frame.
/// @param file a regular file.
/// @throws std::invalid_argument naming it.
TriangleSoup readTriangleSoup(const std::string& file);

/// The same in this process, at the mercy of assimp: for fuzzing, to which a process per file is too slow.
TriangleSoup readTriangleSoupUnprotected(const std::string& file);

}  // namespace tissue_contact
