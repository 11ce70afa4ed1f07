/// @file
/// Room `ros`, private: where instruments came nearest to tissue, in words.
#pragma once

#include <cstdint>
#include <string>

#include "tissue_contact/simulation/simulator.h"

namespace tissue_contact {

/// "closest approach 0.002 m at 12.3 s: 'psm', link 'jaw', shape 1 of 2, to tissue 'liver' at (...); ..." and the shift of the instrument
/// that would make them just touch there.
/// @param approach with a tissue.
std::string approachText(const Simulator& simulator, const Approach& approach, std::int64_t stamp_ns);

}  // namespace tissue_contact
