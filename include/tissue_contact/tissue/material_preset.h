/// @file
/// Room `tissue`: materials by name, with where their numbers come from. The one table of them; doc/organ.md shows it.
#pragma once

#include <string>
#include <vector>

namespace tissue_contact {

struct MaterialPreset {
  const char* name;
  double youngs_modulus_pa;
  double lowest_pa, highest_pa;  ///< of Young's modulus in the source
  double poissons_ratio;
  double density_kg_per_m3;
  double damping_stiffness_s;  ///< DampingDescription::stiffness_s: ours, which calms motion; the sources have none
  const char* basis;           ///< what the source measured, and how Young's modulus follows from it
  const char* source;
};

const std::vector<MaterialPreset>& materialPresets();

/// @throws std::invalid_argument naming the presets there are, the nearest first.
const MaterialPreset& materialPreset(const std::string& name);

}  // namespace tissue_contact
