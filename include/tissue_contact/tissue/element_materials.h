/// @file
/// Room `tissue`: what each element of a tissue is made of.
#pragma once

#include <string>
#include <vector>

#include "tissue_contact/tissue/material_description.h"

namespace tissue_contact {

/// Materials of one model, and which element has which.
struct ElementMaterials {
  // Implicit: a homogeneous tissue is a material.
  ElementMaterials(const MaterialDescription& material) : materials{material} {}  // NOLINT(google-explicit-constructor)
  ElementMaterials() = default;

  std::vector<MaterialDescription> materials;  ///< at least one
  std::vector<int> of_element;                 ///< index into materials; empty: the first everywhere
  /// Stiffness-proportional damping of each material, s, which goes into State::damping. Empty: there is none, or it is
  /// the same everywhere and the step takes it from the stiffness.
  std::vector<double> damping_s;

  std::size_t index(std::size_t element) const {
    return of_element.empty() ? 0 : static_cast<std::size_t>(of_element[element]);
  }
  const MaterialDescription& of(std::size_t element) const { return materials[index(element)]; }
  /// 0 where damping_s is empty.
  double dampingOf(std::size_t element) const { return damping_s.empty() ? 0.0 : damping_s[index(element)]; }
};

/// Lame parameters, Pa.
struct LameParameters {
  double lambda = 0.0;
  double mu = 0.0;
};

/// Lame parameters of a volume: lambda = E nu / ((1 + nu)(1 - 2 nu)), mu = E / (2 (1 + nu)).
LameParameters lameParameters(const MaterialDescription& material);

/// What is left of these without resistance to changes of volume: lambda = -2/3 mu.
LameParameters deviatoricParameters(const MaterialDescription& material);

/// Of plane stress: lambda = E nu / (1 - nu^2), mu = E / (2 (1 + nu)).
LameParameters planeStressParameters(const MaterialDescription& material);

/// @throws std::invalid_argument, its message beginning with `owner`, for Young's modulus, Poisson's ratio or bending
/// stiffness out of range.
void checkMaterial(const MaterialDescription& material, const std::string& owner);

/// Name of a model as in scene files.
const char* elasticModelName(ElasticModel model);

}  // namespace tissue_contact
