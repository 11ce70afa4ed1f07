#include "tissue_contact/tissue/make_elasticity.h"

#include <algorithm>
#include <stdexcept>

#include "tissue/mass_spring.h"
#include "tissue/mean_strain.h"
#include "tissue/neo_hookean.h"
#include "tissue/viscoelastic.h"
#include "tissue_contact/tissue/tet_elasticity.h"

namespace tissue_contact {

bool isContinuum(ElasticModel model) {
  return model == ElasticModel::kLinear || model == ElasticModel::kCorotational || model == ElasticModel::kNeoHookean;
}

bool averagesDilatation(const ElementMaterials& materials) {
  const MaterialDescription& first = materials.materials.at(0);
  if (first.dilatation != Dilatation::kAuto) return first.dilatation == Dilatation::kPatch;
  if (first.distortion == Distortion::kPatch) return true;
  // Averaged neo-Hookean elements give way under sharp edges, which then hook (doc/method.md).
  return isContinuum(first.model) && first.model != ElasticModel::kNeoHookean &&
         std::any_of(materials.materials.begin(), materials.materials.end(),
                     [](const MaterialDescription& one) { return one.poissons_ratio >= kAveragedPoissonsRatio; });
}

bool mayAverageDistortion(ElasticModel model) {
  return model == ElasticModel::kLinear || model == ElasticModel::kCorotational;
}

bool averagesDistortion(const ElementMaterials& materials) {
  const MaterialDescription& first = materials.materials.at(0);
  return mayAverageDistortion(first.model) && first.prony_series.empty() && first.distortion != Distortion::kElement &&
         averagesDilatation(materials);
}

ElementMaterials materialsOf(const TissueDescription& tissue) {
  ElementMaterials materials(tissue.material);
  for (const TissueRegion& region : tissue.regions) materials.materials.push_back(region.material);
  return materials;
}

namespace {

std::unique_ptr<const Elasticity> makeElasticBody(const NodalVectors& rest, const std::vector<Tetrahedron>& tetrahedra,
                                                  const std::vector<bool>& fixed, const ElementMaterials& materials,
                                                  const std::vector<int>& patch_of) {
  const MaterialDescription& first = materials.materials.at(0);
  if (first.dilatation == Dilatation::kPatch && !isContinuum(first.model)) {
    throw std::invalid_argument("dilatation over patches is for the models linear, corotational and neo_hookean only");
  }
  if (first.distortion == Distortion::kPatch && !averagesDistortion(materials)) {
    throw std::invalid_argument(
        "distortion over patches is for the models linear and corotational only, with dilatation over patches and "
        "without a Prony series");
  }
  switch (first.model) {
    case ElasticModel::kLinear:
    case ElasticModel::kCorotational:
      if (averagesDilatation(materials)) {
        return std::make_unique<MeanStrain>(rest, tetrahedra, fixed, materials, patch_of,
                                            averagesDistortion(materials) ? kPatchShapeShare : 0.0);
      }
      return std::make_unique<TetElasticity>(rest, tetrahedra, fixed, materials);
    case ElasticModel::kNeoHookean:
      if (averagesDilatation(materials) && patch_of.empty()) {
        throw std::invalid_argument("dilatation over patches: no patch is given");
      }
      return std::make_unique<NeoHookean>(rest, tetrahedra, fixed, materials,
                                          averagesDilatation(materials) ? patch_of : std::vector<int>());
    case ElasticModel::kMassSpring:
      return std::make_unique<MassSpring>(rest, tetrahedra, fixed, materials);
    case ElasticModel::kMembrane:
      break;
  }
  throw std::invalid_argument(
      "model 'membrane' is for a sheet or shell; a volume takes linear, corotational, neo_hookean or mass_spring");
}

}  // namespace

std::unique_ptr<const Elasticity> makeVolumeElasticity(const NodalVectors& rest,
                                                       const std::vector<Tetrahedron>& tetrahedra,
                                                       const std::vector<bool>& fixed,
                                                       const ElementMaterials& materials,
                                                       const std::vector<int>& patch_of) {
  auto body = makeElasticBody(rest, tetrahedra, fixed, materials, patch_of);
  const MaterialDescription& first = materials.materials.at(0);
  if (first.prony_series.empty()) return body;
  if (!isContinuum(first.model)) {
    throw std::invalid_argument("a Prony series is for the models linear, corotational and neo_hookean only");
  }
  return std::make_unique<Viscoelastic>(std::move(body), rest, tetrahedra, fixed, materials);
}

}  // namespace tissue_contact
