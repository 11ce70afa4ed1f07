/// @file
/// Room `simulation`, private: the likely error of the force on each instrument (force_error.h). The answer of a step in;
/// one estimate per instrument out.
#pragma once

#include <vector>

#include "simulation/momentum_rate.h"
#include "simulation/touched_places.h"
#include "tissue_contact/core/types.h"
#include "tissue_contact/simulation/force_error.h"
#include "tissue_contact/simulation/scene.h"
#include "tissue_contact/simulation/solved_contact.h"
#include "tissue_contact/tissue/tissue.h"

namespace tissue_contact {

/// @param x per tissue: positions, m.
/// @param contacts of the step, sorted by key.
/// @param shapes of the instruments.
/// @param momentum_rates per tissue.
/// @param unbalanced_n what the step's answer leaves, N: of all nodes of a body together.
/// @return one per instrument. Allocates.
std::vector<ForceErrorEstimate> estimateForceErrors(const Scene& scene, const std::vector<Tissue>& tissues,
                                                    const std::vector<NodalVectors>& x,
                                                    const std::vector<SolvedContact>& contacts,
                                                    const TouchedPlaces& shapes, std::size_t instruments,
                                                    const std::vector<MomentumRate>& momentum_rates,
                                                    double unbalanced_n);

}  // namespace tissue_contact
