/// @file
/// Room `ros`, private: where instruments came nearest to tissue, in words.
#pragma once

#include <cstdint>
#include <string>

#include "tissue_contact/simulation/simulator.h"

namespace tissue_contact {

/// Whether an instrument touches tissue in the step taken last.
bool touchesTissue(const Simulator& simulator);

/// After the first step: whether an instrument began within tissue, which it had pressed in before anything is known of it. One that just touched had not.
/// @param start of the instruments where they were placed.
bool beganInContact(const Simulator& simulator, const Approach& start);

/// "closest approach 0.002 m at 12.3 s: 'psm', link 'jaw', shape 1 of 2, to tissue 'liver' at (...); ..." and the shift of the instrument
/// that would make them just touch there.
/// @param approach with a tissue.
std::string approachText(const Simulator& simulator, const Approach& approach, std::int64_t stamp_ns);

}  // namespace tissue_contact
