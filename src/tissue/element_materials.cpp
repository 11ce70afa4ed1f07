#include "tissue_contact/tissue/element_materials.h"

#include "core/name_table.h"
#include "tissue_contact/core/check.h"
#include "tissue_contact/core/entry_error.h"

namespace tissue_contact {

LameParameters lameParameters(const MaterialDescription& material) {
  const double E = material.youngs_modulus_pa;
  const double nu = material.poissons_ratio;
  return {E * nu / ((1.0 + nu) * (1.0 - 2.0 * nu)), E / (2.0 * (1.0 + nu))};
}

LameParameters deviatoricParameters(const MaterialDescription& material) {
  const double mu = lameParameters(material).mu;
  return {-2.0 / 3.0 * mu, mu};
}

LameParameters planeStressParameters(const MaterialDescription& material) {
  const double E = material.youngs_modulus_pa;
  const double nu = material.poissons_ratio;
  return {E * nu / (1.0 - nu * nu), E / (2.0 * (1.0 + nu))};
}

void checkMaterial(const MaterialDescription& material, const std::string& owner) {
  requirePositive(owner + "youngs_modulus_pa", material.youngs_modulus_pa, "Pa");
  MaterialDescription::kPoissonsRatio.require(owner + "poissons_ratio", material.poissons_ratio);
  for (std::size_t k = 0; k < material.prony_series.size(); ++k) {
    const std::string term = owner + elementOf("prony_series", k);
    PronyTerm::kModulusRatio.require(term + ".modulus_ratio", material.prony_series[k].modulus_ratio);
    PronyTerm::kTime.require(term + ".time_s", material.prony_series[k].time_s);
  }
  requireFinite(owner + "bending_stiffness_n_m", material.bending_stiffness_n_m, "N m");
}

const char* elasticModelName(ElasticModel model) { return nameOf(model, kElasticModelNames, "elastic model"); }

}  // namespace tissue_contact
