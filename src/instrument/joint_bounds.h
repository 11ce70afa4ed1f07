/// @file
/// Room `instrument`, private to the package: what a joint's position may be.
#pragma once

#include <cmath>

namespace tissue_contact {

/// Whether it is a place, rad or m, whose difference from another is a number: within 1e9, which no robot comes near.
inline bool isJointPosition(double position) { return std::abs(position) <= 1e9; }

constexpr const char* kJointPositionRange = "finite, between -1e9 and 1e9 (rad or m)";

}  // namespace tissue_contact
