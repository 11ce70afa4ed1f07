#include "tissue_contact/tissue/element_materials.h"

#include "tissue_contact/core/check.h"

namespace tissue_contact {

LameParameters lameParameters(const MaterialDescription& material) {
  const double E = material.youngs_modulus_pa;
  const double nu = material.poissons_ratio;
  return {E * nu / ((1.0 + nu) * (1.0 - 2.0 * nu)), E / (2.0 * (1.0 + nu))};
}

LameParameters planeStressParameters(const MaterialDescription& material) {
  const double E = material.youngs_modulus_pa;
  const double nu = material.poissons_ratio;
  return {E * nu / (1.0 - nu * nu), E / (2.0 * (1.0 + nu))};
}

void checkMaterial(const MaterialDescription& material, const std::string& owner) {
  requirePositive(owner + "youngs_modulus_pa", material.youngs_modulus_pa, "Pa");
  requireInside(owner + "poissons_ratio", material.poissons_ratio, -1.0, 0.5);
  requireFinite(owner + "bending_stiffness_n_m", material.bending_stiffness_n_m, "N m");
}

const char* elasticModelName(ElasticModel model) {
  switch (model) {
    case ElasticModel::kLinear:
      return "linear";
    case ElasticModel::kCorotational:
      return "corotational";
    case ElasticModel::kNeoHookean:
      return "neo_hookean";
    case ElasticModel::kMassSpring:
      return "mass_spring";
    case ElasticModel::kMembrane:
      return "membrane";
  }
  return "unknown";
}

}  // namespace tissue_contact
