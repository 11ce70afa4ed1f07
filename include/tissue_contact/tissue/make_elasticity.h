/// @file
/// Room `tissue`: the elasticity of a volume by the name of its model.
#pragma once

#include <memory>
#include <vector>

#include "tissue_contact/core/types.h"
#include "tissue_contact/tissue/elasticity.h"
#include "tissue_contact/tissue/element_materials.h"
#include "tissue_contact/tissue/tissue_description.h"

namespace tissue_contact {

/// From this Poisson's ratio on Dilatation::kAuto averages, and Distortion::kAuto with it: at 0.45 that takes a third off the error of a
/// press on coarse cells (validation case coarse-press), for twice the blocks of K.
constexpr double kAveragedPoissonsRatio = 0.3;

/// Whether the model is of tetrahedra that obey a law of stress and strain: those may average their strain and relax
/// (MaterialDescription::dilatation, distortion, prony_series).
bool isContinuum(ElasticModel model);

/// Whether volume changes of these materials are averaged over patches: what they ask for, or what kAuto chooses.
bool averagesDilatation(const ElementMaterials& materials);

/// Whether a part of their changes of shape is, likewise; of neo-Hookean ones without the former, a part of all strain.
bool averagesDistortion(const ElementMaterials& materials);

/// Of the tissue and of its regions; where its mesh follows tools, kAuto averages neo-Hookean changes of volume as those of other models.
ElementMaterials materialsOf(const TissueDescription& tissue);

/// @param rest 3 x n, m.
/// @param materials all of the model, dilatation and distortion of the first.
/// @param patch_of of each tetrahedron, for materials that average their strain or dilatation (see MeanStrain); not used
///   for others.
/// @throws std::invalid_argument for a material out of range, a membrane (see membrane.h), which a volume cannot be, or
///   patches for a model without them.
std::unique_ptr<const Elasticity> makeVolumeElasticity(const NodalVectors& rest,
                                                       const std::vector<Tetrahedron>& tetrahedra,
                                                       const std::vector<bool>& fixed,
                                                       const ElementMaterials& materials,
                                                       const std::vector<int>& patch_of);

}  // namespace tissue_contact
