/// @file
/// Room `tissue`: what a tissue is made of.
#pragma once

#include <utility>
#include <vector>

#include "tissue_contact/core/range.h"

namespace tissue_contact {

/// kLinear to kMassSpring are for volumes (block, mesh); kMembrane is for surfaces (sheet, shell) and their only model.
enum class ElasticModel { kLinear, kCorotational, kNeoHookean, kMassSpring, kMembrane };

/// As in scene files.
constexpr std::pair<const char*, ElasticModel> kElasticModelNames[] = {{"linear", ElasticModel::kLinear},
                                                                       {"corotational", ElasticModel::kCorotational},
                                                                       {"neo_hookean", ElasticModel::kNeoHookean},
                                                                       {"mass_spring", ElasticModel::kMassSpring},
                                                                       {"membrane", ElasticModel::kMembrane}};

/// Over what a linear, corotational or neo-Hookean volume averages its change of volume.
enum class Dilatation {
  kAuto,     ///< kPatch for linear and corotational bodies from Poisson's ratio 0.3 on, where it pays; else kElement
  kElement,  ///< each tetrahedron: locks as Poisson's ratio nears 1/2
  kPatch     ///< the five tetrahedra of a block's cell, or about five neighbours of a mesh: does not
};

/// Over what a linear or corotational volume that averages its change of volume averages a part of its change of shape, and a
/// neo-Hookean one a part of all strain.
enum class Distortion {
  kAuto,  ///< kPatch where dilatation is averaged (neo-Hookean: from nu 0.3 on, too) and no stress relaxes, else kElement
  kElement,  ///< each tetrahedron: stiff in bending
  kPatch     ///< as Dilatation::kPatch: a third to a half less error of a press, neo-Hookean a tenth to a third
};

/// One term of a Prony series: a Maxwell element beside the elastic body.
struct PronyTerm {
  static constexpr Range kModulusRatio{0.0, 1000.0, "", "the shear modulus of the term over the relaxed one", true};
  static constexpr Range kTime{1e-4, 1e5, "s", "give seconds"};

  double modulus_ratio = 0.0;  ///< its shear modulus over that of the relaxed body
  double time_s = 0.0;         ///< in which its stress falls to 1/e while the strain is held
};

struct MaterialPreset;

struct MaterialDescription {
  static constexpr Range kPoissonsRatio{-1.0, 0.5, "", "0.5 itself (incompressible) cannot be simulated, 0.49 can",
                                        true, true};

  ElasticModel model = ElasticModel::kCorotational;
  double youngs_modulus_pa = 0.0;
  double poissons_ratio = 0.0;
  double density_kg_per_m3 = 0.0;
  /// Membranes: bending stiffness per width, N m; negative: that of a plate, E h^3 / (12 (1 - nu^2)).
  double bending_stiffness_n_m = -1.0;
  Dilatation dilatation = Dilatation::kAuto;
  /// Volumes but for mass-spring: stress relaxation of the deviator. Young's modulus is then that of the relaxed body. The
  /// terms are those of the whole tissue, times the modulus of each region.
  std::vector<PronyTerm> prony_series = {};
  /// Of materialPresets(), by whose name the scene has its constants, all or some; null: none. To be told, not computed with.
  const MaterialPreset* preset = nullptr;
  Distortion distortion = Distortion::kAuto;
};

/// Damping matrix D = mass_per_s * M + stiffness_s * K (Rayleigh; the second part is Kelvin-Voigt's, with
/// viscosity = stiffness_s * modulus).
struct DampingDescription {
  double mass_per_s = 0.0;
  double stiffness_s = 0.0;
};

}  // namespace tissue_contact
