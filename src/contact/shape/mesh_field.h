/// @file
/// Room `contact`, private: a mesh shape as contact detection uses it. Triangles in; sampled distance out.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "contact/shape/distance_grid.h"
#include "tissue_contact/mesh/mesh_preparation.h"
#include "tissue_contact/mesh/triangle_mesh.h"

namespace tissue_contact {

/// The point of a needle or a cone: edges leave it within 30 degrees of one direction, into the tool. The samples blunt it.
struct MeshTip {
  Vector3 p_S = Vector3::Zero();
  std::vector<Vector3> edges;  ///< unit, from the tip
};

/// Grid, box and deviations are in the frame G of the grid, about the same origin as the shape's frame S.
struct MeshField {
  Matrix3 R_SG = Matrix3::Identity();  ///< axes of the grid (gridAxes()); not in the cache
  std::vector<MeshTip> tips;           ///< in S; not in the cache
  DistanceGrid grid;
  Vector3 low = Vector3::Zero();  ///< corners of the mesh's bounding box, m
  Vector3 high = Vector3::Zero();
  /// Distance from the points of the mesh's outer surface to the shape, m, weighted by area; of a part that
  /// fell between the samples, to what is left.
  double largest_deviation = 0.0;
  double rms_deviation = 0.0;
  double median_deviation = 0.0;
};

/// @param name of the mesh, for what is said.
/// @param preparation its cache is given up when it cannot be written to, which is said once.
/// @param sample_count of the grid, about. The default takes 4 MB; the jaws of an 8 mm instrument get 0.1 mm.
/// @throws std::invalid_argument when the mesh has no usable triangle, an index out of range, or no inside.
std::shared_ptr<const MeshField> prepareMeshField(const TriangleMesh& mesh, const std::string& name,
                                                  MeshPreparation& preparation, double sample_count = 1e6);

}  // namespace tissue_contact
