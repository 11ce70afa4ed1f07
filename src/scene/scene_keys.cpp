#include "scene_keys.h"

#include <map>

namespace tissue_contact {
namespace {

const std::map<MapKind, SceneMapKeys>& tables() {
  static const std::map<MapKind, SceneMapKeys> all = {
      {MapKind::kScene,
       {"scene",
        {"world_frame", "gravity_m_per_s2", "tissues", "instruments", "tissue_pairs", "friction", "step", "solver",
         "advisor", "publish"}}},
      {MapKind::kTissue,
       {"tissues[]",
        {"name", "block", "mesh", "sheet", "shell", "pose", "material", "damping", "fibre_direction", "regions",
         "fixed"}}},
      {MapKind::kBlock, {"tissues[].block", {"size_m", "cells", "grading"}}},
      {MapKind::kGrading, {"tissues[].block.grading", {"x", "y", "z"}}},
      {MapKind::kAxisGrading, {"tissues[].block.grading.x", {"growth", "fine_at"}}},
      {MapKind::kMesh, {"tissues[].mesh", {"file", "scale_m_per_unit", "remove_unreferenced_nodes"}}},
      {MapKind::kSheet, {"tissues[].sheet", {"size_m", "cells", "thickness_m"}}},
      {MapKind::kShell, {"tissues[].shell", {"file", "scale_m_per_unit", "thickness_m"}}},
      {MapKind::kMaterial,
       {"tissues[].material",
        {"model", "dilatation", "youngs_modulus_pa", "poissons_ratio", "density_kg_per_m3", "bending_stiffness_n_m"}}},
      {MapKind::kDamping, {"tissues[].damping", {"mass_per_s", "stiffness_s"}}},
      {MapKind::kFixedRegion, {"tissues[].fixed[]", {"box", "plane", "sphere"}}},
      {MapKind::kFixedBox, {"tissues[].fixed[].box", {"min_m", "max_m"}}},
      {MapKind::kFixedPlane, {"tissues[].fixed[].plane", {"point_m", "normal"}}},
      {MapKind::kFixedSphere, {"tissues[].fixed[].sphere", {"center_m", "radius_m"}}},
      {MapKind::kTissueRegion, {"tissues[].regions[]", {"name", "where", "material", "damping", "fibre_direction"}}},
      {MapKind::kRegionMaterial,
       {"tissues[].regions[].material", {"youngs_modulus_pa", "poissons_ratio", "density_kg_per_m3"}}},
      {MapKind::kRegionDamping, {"tissues[].regions[].damping", {"stiffness_s"}}},
      {MapKind::kInstrument,
       {"instruments[]",
        {"name", "urdf", "robot_description", "base_pose", "joint_state_topics", "joint_names",
         "initial_joint_positions", "tip_link", "contact_links"}}},
      {MapKind::kJointStateTopic, {"instruments[].joint_state_topics[]", {"topic", "triggers"}}},
      {MapKind::kContactLink, {"instruments[].contact_links[]", {"link", "shapes"}}},
      {MapKind::kShape, {"instruments[].contact_links[].shapes[]", {"sphere", "box", "cylinder", "mesh", "pose"}}},
      {MapKind::kShapeSphere, {"instruments[].contact_links[].shapes[].sphere", {"radius_m"}}},
      {MapKind::kShapeBox, {"instruments[].contact_links[].shapes[].box", {"size_m"}}},
      {MapKind::kShapeCylinder, {"instruments[].contact_links[].shapes[].cylinder", {"radius_m", "length_m"}}},
      {MapKind::kShapeMesh, {"instruments[].contact_links[].shapes[].mesh", {"file", "scale"}}},
      {MapKind::kShapePose,
       {"instruments[].contact_links[].shapes[].pose", {"position_m", "rpy_rad", "quaternion_xyzw"}}},
      {MapKind::kPose, {"tissues[].pose", {"position_m", "rpy_rad", "quaternion_xyzw", "tf_frame"}}},
      {MapKind::kTissuePair, {"tissue_pairs[]", {"tissue", "other"}}},
      {MapKind::kFriction,
       {"friction[]",
        {"instrument", "other_tissue", "link", "tissue", "region", "law", "static", "kinetic", "angles_rad", "axis",
         "speeds_m_per_s", "speed_factors"}}},
      {MapKind::kFrictionAxis, {"friction[].axis", {"link_direction"}}},
      {MapKind::kStep, {"step", {"max_step_s", "max_gap_s", "joint_states", "max_lag_s"}}},
      {MapKind::kSolver,
       {"solver",
        {"method", "relaxation", "iterations", "contact_passes", "tolerance", "time_budget_s", "cone_sides"}}},
      {MapKind::kAdvisor, {"advisor", {"sleep", "sleep_error", "rotations", "self_contact", "friction_path"}}},
      {MapKind::kPublish, {"publish", {"mesh_rate_hz", "contacts_rate_hz", "status_rate_hz", "markers_rate_hz", "tf"}}},
  };
  return all;
}

}  // namespace

const SceneMapKeys& mapKeys(MapKind kind) { return tables().at(kind); }

std::vector<SceneMapKeys> sceneKeys() {
  std::vector<SceneMapKeys> all;
  for (const auto& table : tables()) all.push_back(table.second);
  return all;
}

}  // namespace tissue_contact
