/// @file
/// Room `contact`, private: where a sampled distance is none, because the mesh it came from does not close.
#pragma once

#include "contact/distance_grid.h"

namespace tissue_contact {

/// Where inside and outside meet without a surface between them: across an opening of the mesh.
struct FieldJump {
  double width_m = 0.0;  ///< by how much the distance jumps, which is about the width of the opening; 0: nowhere
  Vector3 p_S = Vector3::Zero();  ///< between the samples where it jumps most, about the middle of the opening
};

/// Of two neighbouring samples on different sides the surface passes between, so both together are no farther from it than the
/// samples from each other. Looked at are those that differ by more than twice that, since where shells pass through
/// each other the outer surface is known to some spacings only.
FieldJump widestJump(const DistanceGrid& grid);

}  // namespace tissue_contact
