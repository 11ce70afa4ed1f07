/// @file
/// Room `scene`, private: the allowed numbers that more than one reader of a scene checks: the file's parser, and changes while it
/// is simulated.
#pragma once

#include "tissue_contact/core/range.h"

namespace tissue_contact {

constexpr Range kYoungRange{1.0, 1e12, "Pa", "give pascals: 5 kPa is 5000, 1 MPa is 1e6"};
constexpr Range kMassDampingRange{0.0, 1e4, "1/s"};
constexpr Range kStiffnessDampingRange{0.0, 10.0, "s", "give seconds: 2 ms is 0.002"};

// Narrower than what a law can bear: typing errors.
constexpr Range kCoefficientRange{0.0, 10.0};
constexpr Range kTensorRange{-10.0, 10.0};

constexpr int kMaxIterations = 10000;
constexpr int kMaxContactPasses = 100;
// Below the spacing of doubles near 1 a residual can never fall.
constexpr Range kToleranceRange{1e-16, 0.1};

constexpr Range kMaxLagRange{1e-6, 60.0, "s", "give seconds: 20 ms is 0.02"};

}  // namespace tissue_contact
