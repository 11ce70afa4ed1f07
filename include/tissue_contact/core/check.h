/// @file
/// Room `core`: input checks. Each throws std::invalid_argument naming the thing, its value, the allowed range and the
/// unit. Comparisons are written so that NaN fails.
#pragma once

#include <cmath>
#include <limits>
#include <sstream>
#include <stdexcept>
#include <string>

namespace tissue_contact {

/// Throws std::invalid_argument("<what> is <value> <unit>; <must>").
[[noreturn]] inline void throwBadValue(const std::string& what, double value, const std::string& unit,
                                       const std::string& must) {
  std::ostringstream message;
  message.precision(std::numeric_limits<double>::max_digits10);
  message << what << " is " << value << (unit.empty() ? "" : " " + unit) << "; it must be " << must;
  throw std::invalid_argument(message.str());
}

/// Returns `value` if it is finite and > 0, else throws.
inline double requirePositive(const std::string& what, double value, const std::string& unit = "") {
  if (!(value > 0.0) || !std::isfinite(value)) throwBadValue(what, value, unit, "finite and > 0");
  return value;
}

/// Returns `value` if it is finite and >= 0, else throws.
inline double requireNonNegative(const std::string& what, double value, const std::string& unit = "") {
  if (!(value >= 0.0) || !std::isfinite(value)) throwBadValue(what, value, unit, "finite and >= 0");
  return value;
}

/// Returns `value` if it is finite, else throws.
inline double requireFinite(const std::string& what, double value, const std::string& unit = "") {
  if (!std::isfinite(value)) throwBadValue(what, value, unit, "finite");
  return value;
}

}  // namespace tissue_contact
