/// @file
/// Room `baselines`, private: contact states read off an answer, and hysteresis as a sequence of problems with one
/// coefficient of friction per contact. For solvers that treat all contacts at once.
#pragma once

#include <vector>

#include "tissue_contact/baselines/delassus.h"

namespace tissue_contact {

/// The coefficient each contact starts with: static, unless it was sliding before the step or `states` say it slides.
/// @param states per contact, or empty.
VectorX chooseCoefficients(const DelassusProblem& problem, const std::vector<ContactState>& states);

/// Contacts that slide in answer r while their coefficient is the static one get the kinetic one. Only ever in this
/// direction, so repeating it ends.
/// @param round_off sliding in natural units (natural_map.h) that counts as none.
/// @return some contact did.
bool releaseSliding(const DelassusProblem& problem, const VectorX& r, double round_off, VectorX& mu);

/// Answer r with its velocities and states. Of two complementary quantities the larger decides: normal impulse or
/// separation; unused friction or sliding.
DelassusSolution answerWith(const DelassusProblem& problem, const VectorX& mu, const VectorX& r, double round_off);

}  // namespace tissue_contact
