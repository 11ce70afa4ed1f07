/// @file
/// Room `mesh`: parts of space that name nodes and elements.
#pragma once

#include <memory>
#include <string>
#include <variant>
#include <vector>

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
struct GroupRegion {  ///< a physical group of a Gmsh mesh
  std::string name;   ///< or its number, as text
};
struct CellDataRegion {  ///< the tetrahedra of a VTK mesh whose value in an array of cell data is this
  std::string name;
  double value = 0.0;
};
/// Either of the two once the mesh is read: points within rounding of these, m in T.
struct MemberRegion {
  std::string label;                                   ///< for messages
  std::shared_ptr<const std::vector<Vector3>> places;  ///< ascending by placeOrder()
};
using Region = std::variant<BoxRegion, PlaneRegion, SphereRegion, GroupRegion, CellDataRegion, MemberRegion>;

}  // namespace tissue_contact
