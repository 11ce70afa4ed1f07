/// @file
/// Room `tissue`: everything that a tissue is built from, in SI units.
#pragma once

#include <string>
#include <variant>
#include <vector>

#include "tissue_contact/core/placed_pose.h"
#include "tissue_contact/core/types.h"
#include "tissue_contact/mesh/mesh_description.h"
#include "tissue_contact/mesh/refinement_description.h"
#include "tissue_contact/mesh/region_description.h"
#include "tissue_contact/tissue/material_description.h"

namespace tissue_contact {

/// A named part of a tissue with a material, damping, fibre direction or friction of its own: the elements (and surface
/// triangles) of the mesh that nothing touches whose centroid lies in any of `where`. Where several regions hold an element, the last one counts.
struct TissueRegion {
  std::string name;                  ///< unique in its tissue
  std::vector<Region> where;         ///< in the tissue frame T, at rest
  MaterialDescription material;      ///< that of the tissue where the scene gives none; same `model` as the tissue's
  double damping_stiffness_s = 0.0;  ///< that of the tissue where the scene gives none
  Vector3 fibre_direction = Vector3::Zero();  ///< that of the tissue where the scene gives none
};

/// Springs from nodes to where they rest in the world, alike in all directions: f = -k (x - x_rest). Where attachments
/// overlap, their stiffnesses add up. They are damped like the tissue: D of a spring is DampingDescription::stiffness_s
/// of the tissue times k.
struct Attachment {
  std::vector<Region> where;  ///< in T, at rest; none: refused
  /// Of a bed of springs, N/m per m^2 of the surface triangles whose centroid lies in `where`, shared in equal parts by
  /// their corners. 0: not given.
  double stiffness_pa_per_m = 0.0;
  double stiffness_n_per_m = 0.0;  ///< of each node in `where`, N/m. 0: not given; exactly one of the two is
};

struct TissueDescription {
  std::string name;
  std::variant<BlockDescription, MeshDescription, SheetDescription, ShellDescription> geometry;
  RefinementDescription refinement;  ///< of a volume
  PoseDescription pose;              ///< of the tissue frame T
  MaterialDescription material;
  DampingDescription damping;
  Vector3 fibre_direction = Vector3::Zero();  ///< at rest, in T, any length; zero: none. Carried by the deformation
  std::vector<TissueRegion> regions;
  std::vector<Region> fixed;            ///< none: a free body, unless attached
  std::vector<Attachment> attachments;  ///< beside `fixed`
  /// On the surface, along its inward normal as it deforms (a membrane: against the normal of its triangles), Pa.
  double pressure_pa = 0.0;
  std::vector<Region> pressure_where;  ///< the surface triangles whose centroid it holds at rest, in T; none: all
};

inline bool isMembrane(const TissueDescription& tissue) {
  return std::holds_alternative<SheetDescription>(tissue.geometry) ||
         std::holds_alternative<ShellDescription>(tissue.geometry);
}

}  // namespace tissue_contact
