#include "tissue_contact/tissue/make_elasticity.h"

#include <stdexcept>

#include "tissue_contact/tissue/mass_spring.h"
#include "tissue_contact/tissue/neo_hookean.h"
#include "tissue_contact/tissue/tet_elasticity.h"

namespace tissue_contact {

std::unique_ptr<const Elasticity> makeVolumeElasticity(const NodalVectors& rest,
                                                       const std::vector<Tetrahedron>& tetrahedra,
                                                       const std::vector<bool>& fixed,
                                                       const ElementMaterials& materials) {
  switch (materials.materials.at(0).model) {
    case ElasticModel::kLinear:
    case ElasticModel::kCorotational:
      return std::make_unique<TetElasticity>(rest, tetrahedra, fixed, materials);
    case ElasticModel::kNeoHookean:
      return std::make_unique<NeoHookean>(rest, tetrahedra, fixed, materials);
    case ElasticModel::kMassSpring:
      return std::make_unique<MassSpring>(rest, tetrahedra, fixed, materials);
    case ElasticModel::kMembrane:
      break;
  }
  throw std::invalid_argument(
      "model 'membrane' is for a sheet or shell; a volume takes linear, corotational, neo_hookean or mass_spring");
}

}  // namespace tissue_contact
