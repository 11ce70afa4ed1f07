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

namespace {

bool averagesByItself(const ElementMaterials& materials) {
  return isContinuum(materials.materials.at(0).model) &&
         std::any_of(materials.materials.begin(), materials.materials.end(),
                     [](const MaterialDescription& one) { return one.poissons_ratio >= kAveragedPoissonsRatio; });
}

}  // namespace

bool averagesDilatation(const ElementMaterials& materials) {
  const MaterialDescription& first = materials.materials.at(0);
  if (first.dilatation != Dilatation::kAuto) return first.dilatation == Dilatation::kPatch;
  // Neo-Hookean elements that average all of the change of volume give way under sharp edges, which then hook (doc/method.md).
  if (first.model == ElasticModel::kNeoHookean) return false;
  return first.distortion == Distortion::kPatch || averagesByItself(materials);
}

bool averagesDistortion(const ElementMaterials& materials) {
  const MaterialDescription& first = materials.materials.at(0);
  if (!isContinuum(first.model) || !first.prony_series.empty()) return false;
  if (first.distortion != Distortion::kAuto) return first.distortion == Distortion::kPatch;
  return first.dilatation == Dilatation::kPatch ||
         (first.dilatation == Dilatation::kAuto && averagesByItself(materials));
}

ElementMaterials materialsOf(const TissueDescription& tissue) {
  ElementMaterials materials(tissue.material);
  for (const TissueRegion& region : tissue.regions) materials.materials.push_back(region.material);
  // Averaged elements hook sharp edges in cells much wider than these: a mesh that follows has none there, and far away, where its cells
  // are wide, it would lock.
  MaterialDescription& first = materials.materials[0];
  if (tissue.refinement.mode != RefinementDescription::Mode::kNever && first.model == ElasticModel::kNeoHookean &&
      first.dilatation == Dilatation::kAuto &&
      (first.distortion == Distortion::kPatch || averagesByItself(materials))) {
    first.dilatation = Dilatation::kPatch;
  }
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
  if (first.distortion == Distortion::kPatch &&
      (!averagesDistortion(materials) || first.dilatation == Dilatation::kElement)) {
    throw std::invalid_argument(
        "distortion over patches is for the models linear, corotational and neo_hookean only, with dilatation over "
        "patches or as it comes and without a Prony series");
  }
  switch (first.model) {
    case ElasticModel::kLinear:
    case ElasticModel::kCorotational:
      if (averagesDilatation(materials)) {
        return std::make_unique<MeanStrain>(rest, tetrahedra, fixed, materials, patch_of,
                                            averagesDistortion(materials) ? kPatchShapeShare : 0.0);
      }
      return std::make_unique<TetElasticity>(rest, tetrahedra, fixed, materials);
    case ElasticModel::kNeoHookean: {
      const NeoHookean::Averages averages = {averagesDilatation(materials),
                                             averagesDistortion(materials) ? kPatchShapeShare : 0.0};
      if (!averages.dilatation && averages.share == 0.0) {
        return std::make_unique<NeoHookean>(rest, tetrahedra, fixed, materials);
      }
      if (patch_of.empty()) throw std::invalid_argument("strain averaged over patches: no patch is given");
      return std::make_unique<NeoHookean>(rest, tetrahedra, fixed, materials, patch_of, averages);
    }
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
