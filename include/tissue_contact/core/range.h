/// @file
/// Room `core`: allowed numbers, stated once for whoever reads, checks or documents them.
#pragma once

#include <string>

namespace tissue_contact {

/// From `low` to `high`. An excluded bound is not itself allowed; NaN never is.
struct Range {
  double low;
  double high;
  const char* unit = "";  ///< named in messages; empty for a dimensionless number
  const char* fix = "";   ///< what to do about a value outside, or empty
  bool low_excluded = false;
  bool high_excluded = false;

  bool contains(double value) const {
    return (low_excluded ? value > low : value >= low) && (high_excluded ? value < high : value <= high);
  }

  /// ">= 0 and < 10 m".
  std::string text() const;

  /// Returns `value`.
  /// @throws std::invalid_argument naming `what`, the value, the range and the fix if it is outside.
  double require(const std::string& what, double value) const;
};

}  // namespace tissue_contact
