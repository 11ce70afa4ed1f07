/// @file
/// Room `tissue`, private: springs along the edges of a tetrahedral mesh and how stiff they are.
#pragma once

#include <array>
#include <vector>

#include "tissue/block_slots.h"
#include "tissue_contact/core/types.h"
#include "tissue_contact/tissue/element_materials.h"

namespace tissue_contact {

struct Spring {
  std::array<int, 2> nodes;  ///< ascending
  double length;             ///< at rest, m
  double stiffness;          ///< N/m
  double damping;            ///< N s/m, what of it goes into State::damping
  BlockSlots<2> slots;
};

/// One spring per edge, in ascending order of its nodes; `slots` are left for the caller to fill. Formulas and sources:
/// mass_spring.h.
std::vector<Spring> makeSprings(const NodalVectors& rest, const std::vector<Tetrahedron>& tetrahedra,
                                const ElementMaterials& materials);

}  // namespace tissue_contact
