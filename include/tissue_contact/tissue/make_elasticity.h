/// @file
/// Room `tissue`: the elasticity of a volume by the name of its model.
#pragma once

#include <memory>
#include <vector>

#include "tissue_contact/core/types.h"
#include "tissue_contact/tissue/elasticity.h"
#include "tissue_contact/tissue/element_materials.h"

namespace tissue_contact {

/// @param rest 3 x n, m. @param materials all of the model of the first.
/// @throws std::invalid_argument for a material out of range, or a membrane (see membrane.h), which a volume cannot be.
std::unique_ptr<const Elasticity> makeVolumeElasticity(const NodalVectors& rest,
                                                       const std::vector<Tetrahedron>& tetrahedra,
                                                       const std::vector<bool>& fixed,
                                                       const ElementMaterials& materials);

}  // namespace tissue_contact
