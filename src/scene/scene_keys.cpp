#include <array>
#include <utility>

#include "scene/yaml_reader.h"
#include "tissue_contact/scene/load_scene.h"

namespace tissue_contact {
namespace {

/// Maps whose keys stand in the table once, with those below them.
constexpr std::array<std::pair<const char*, const char*>, 6> kSame = {{
    {"instruments[].base_pose", "tissues[].pose"},
    {"tissues[].block.grading.y", "tissues[].block.grading.x"},
    {"tissues[].block.grading.z", "tissues[].block.grading.x"},
    {"tissues[].regions[].where[]", "tissues[].fixed[]"},
    {"tissues[].attachments[].where[]", "tissues[].fixed[]"},
    {"tissues[].pressure_where[]", "tissues[].fixed[]"},
}};

}  // namespace

std::string tablePath(const std::string& path) {
  std::string kind;
  bool is_number = false;
  for (const char c : path) {
    is_number &= c != ']';
    if (!is_number) kind += c;
    is_number |= c == '[';
  }
  for (const auto& [one, other] : kSame) {
    if (kind.rfind(one, 0) == 0) return other + kind.substr(std::string(one).size());
  }
  return kind.empty() ? "scene" : kind;
}

const std::map<std::string, std::vector<std::string>>& sceneKeys() {
  static const std::map<std::string, std::vector<std::string>> all = {
      {"scene",
       {"world_frame", "gravity_m_per_s2", "tissues", "instruments", "tissue_pairs", "friction", "step", "solver",
        "advisor", "publish"}},
      {"tissues[]",
       {"name", "block", "mesh", "sheet", "shell", "pose", "material", "damping", "fibre_direction", "regions", "fixed",
        "attachments", "pressure_pa", "pressure_where", "refinement"}},
      {"tissues[].refinement", {"cell_m", "reach_m", "growth", "nodes_at_most"}},
      {"tissues[].block", {"size_m", "cells", "grading"}},
      {"tissues[].block.grading", {"x", "y", "z"}},
      {"tissues[].block.grading.x", {"growth", "fine_at"}},
      {"tissues[].mesh",
       {"file", "scale_m_per_unit", "remove_unreferenced_nodes", "coincident_nodes", "cell_size_m",
        "cell_size_inside_m"}},
      {"tissues[].sheet", {"size_m", "cells", "thickness_m"}},
      {"tissues[].shell", {"file", "scale_m_per_unit", "thickness_m"}},
      {"tissues[].material",
       {"preset", "model", "dilatation", "distortion", "youngs_modulus_pa", "poissons_ratio", "density_kg_per_m3",
        "prony_series", "bending_stiffness_n_m"}},
      {"tissues[].material.prony_series[]", {"modulus_ratio", "time_s"}},
      {"tissues[].damping", {"mass_per_s", "stiffness_s"}},
      {"tissues[].fixed[]", {"box", "plane", "sphere", "group", "cell_data"}},
      {"tissues[].fixed[].cell_data", {"name", "value"}},
      {"tissues[].fixed[].box", {"min_m", "max_m"}},
      {"tissues[].fixed[].plane", {"point_m", "normal"}},
      {"tissues[].fixed[].sphere", {"center_m", "radius_m"}},
      {"tissues[].attachments[]", {"where", "stiffness_pa_per_m", "stiffness_n_per_m"}},
      {"tissues[].regions[]", {"name", "where", "material", "damping", "fibre_direction"}},
      {"tissues[].regions[].material", {"preset", "youngs_modulus_pa", "poissons_ratio", "density_kg_per_m3"}},
      {"tissues[].regions[].damping", {"stiffness_s"}},
      {"instruments[]",
       {"name", "urdf", "robot_description", "base_pose", "joint_state_topics", "joint_names",
        "initial_joint_positions", "compliant_joints", "tip_link", "contact_links"}},
      {"instruments[].compliant_joints[]",
       {"joint", "stiffness_n_m_per_rad", "torque_limit_n_m", "stiffness_n_per_m", "force_limit_n"}},
      {"instruments[].joint_state_topics[]", {"topic", "triggers"}},
      {"instruments[].contact_links[]", {"link", "shapes"}},
      {"instruments[].contact_links[].shapes[]", {"sphere", "box", "cylinder", "mesh", "pose"}},
      {"instruments[].contact_links[].shapes[].sphere", {"radius_m"}},
      {"instruments[].contact_links[].shapes[].box", {"size_m"}},
      {"instruments[].contact_links[].shapes[].cylinder", {"radius_m", "length_m"}},
      {"instruments[].contact_links[].shapes[].mesh", {"file", "scale"}},
      {"instruments[].contact_links[].shapes[].pose", {"position_m", "rpy_rad", "quaternion_xyzw"}},
      {"tissues[].pose", {"position_m", "rpy_rad", "quaternion_xyzw", "tf_frame"}},
      {"tissue_pairs[]", {"tissue", "other"}},
      {"friction[]",
       {"instrument", "other_tissue", "link", "tissue", "region", "law", "static", "kinetic", "angles_rad", "axis",
        "speeds_m_per_s", "speed_factors", "pressures_pa", "pressure_factors"}},
      {"friction[].axis", {"link_direction"}},
      {"step", {"max_step_s", "max_gap_s", "joint_states", "max_lag_s"}},
      {"solver", {"method", "relaxation", "iterations", "contact_passes", "tolerance", "time_budget_s", "cone_sides"}},
      {"advisor", {"sleep", "sleep_error", "rotations", "self_contact", "friction_path"}},
      {"publish", {"mesh_rate_hz", "contacts_rate_hz", "status_rate_hz", "markers_rate_hz", "tf", "crtk"}},
  };
  return all;
}

const std::vector<std::string>& keysAt(const std::string& path) { return sceneKeys().at(tablePath(path)); }

}  // namespace tissue_contact
