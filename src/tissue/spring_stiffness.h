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

/// Least factor w of a spring (mass_spring.h). Where isotropy asks for less, it is given up: half of the nodes of a block
/// hang on the springs along its axes alone, and yield under a tool or the body's weight where these are nearly nothing.
/// Over the corotational model of Poisson's ratio 1/4 on the same mesh, with a least factor of .1, .4 and .7: a ball pressed
/// in by 2 mm pushes back with .52, .75, .78 on cells 1.5 times as wide as high and with .21, .31, .38 on those twice as
/// wide; a column of cells three times as wide as high sags 23, 1.8, 1.9 times as far. Cubes ask for .6, which .7 would take from them.
constexpr double kLeastSpringFactor = 0.4;

/// One spring per edge, in ascending order of its nodes; `slots` are left for the caller to fill. Formulas and sources:
/// mass_spring.h.
std::vector<Spring> makeSprings(const NodalVectors& rest, const std::vector<Tetrahedron>& tetrahedra,
                                const ElementMaterials& materials);

/// The least factor that would make springs along these edges isotropic; springs have kLeastSpringFactor where it is
/// below that. @pre there are elements.
double leastWantedSpringFactor(const NodalVectors& rest, const std::vector<Tetrahedron>& tetrahedra);

}  // namespace tissue_contact
