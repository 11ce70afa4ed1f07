/// @file
/// Room `mesh`: parts of space that name nodes and elements.
#pragma once

#include <variant>

#include "tissue_contact/core/types.h"

namespace tissue_contact {

/// Regions of the tissue frame T (boundaries included): where nodes are held, where a material or pressure acts.
struct BoxRegion {
  Vector3 min_m = Vector3::Zero();
  Vector3 max_m = Vector3::Zero();
};
struct PlaneRegion {  ///< nodes on the plane or on the side the normal points away from: normal . (x - point) <= 0
  Vector3 point_m = Vector3::Zero();
  Vector3 normal = Vector3::UnitZ();
};
struct SphereRegion {
  Vector3 center_m = Vector3::Zero();
  double radius_m = 0.0;
};
using Region = std::variant<BoxRegion, PlaneRegion, SphereRegion>;

}  // namespace tissue_contact
