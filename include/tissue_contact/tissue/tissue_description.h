/// @file
/// Room `tissue`: everything that a tissue is built from, in SI units.
#pragma once

#include <string>
#include <variant>
#include <vector>

#include "tissue_contact/core/placed_pose.h"
#include "tissue_contact/core/types.h"
#include "tissue_contact/mesh/mesh_description.h"
#include "tissue_contact/mesh/region_description.h"
#include "tissue_contact/tissue/material_description.h"

namespace tissue_contact {

/// A named part of a tissue with a material, damping, fibre direction or friction of its own: the elements (and surface
/// triangles) whose centroid lies in any of `where`. Where several regions hold an element, the last one counts.
struct TissueRegion {
  std::string name;                  ///< unique in its tissue
  std::vector<Region> where;         ///< in the tissue frame T, at rest
  MaterialDescription material;      ///< that of the tissue where the scene gives none; same `model` as the tissue's
  double damping_stiffness_s = 0.0;  ///< that of the tissue where the scene gives none
  Vector3 fibre_direction = Vector3::Zero();  ///< that of the tissue where the scene gives none
};

struct TissueDescription {
  std::string name;
  std::variant<BlockDescription, MeshDescription, SheetDescription, ShellDescription> geometry;
  PoseDescription pose;  ///< of the tissue frame T
  MaterialDescription material;
  DampingDescription damping;
  Vector3 fibre_direction = Vector3::Zero();  ///< at rest, in T, any length; zero: none. Carried by the deformation
  std::vector<TissueRegion> regions;
  std::vector<Region> fixed;  ///< none: a free body
};

inline bool isMembrane(const TissueDescription& tissue) {
  return std::holds_alternative<SheetDescription>(tissue.geometry) ||
         std::holds_alternative<ShellDescription>(tissue.geometry);
}

}  // namespace tissue_contact
