#include "friction/check_friction_law.h"

#include <cmath>
#include <limits>
#include <sstream>
#include <stdexcept>
#include <string>

#include "core/name_table.h"
#include "tissue_contact/core/check.h"
#include "tissue_contact/core/entry_error.h"

namespace tissue_contact {
namespace {

using Kind = FrictionLawDescription::Kind;

/// Round-off of typed decimals, as a share of the size of a matrix.
constexpr double kDecimalRoundOff = 1e-12;

std::string text(double value) {
  std::ostringstream stream;
  stream.precision(std::numeric_limits<double>::max_digits10);
  stream << value;
  return stream.str();
}

std::size_t expectedCount(const FrictionLawDescription& law) {
  switch (law.kind) {
    case Kind::kIsotropic:
      return 1;
    case Kind::kOrthotropic:
      return 2;
    case Kind::kAsymmetric:
      return 3;
    case Kind::kTable:
      return law.angles_rad.size();
    case Kind::kTensor:
      return 4;
  }
  return 0;
}

void checkCount(const std::string& what, std::size_t count, std::size_t expected, const char* why) {
  if (count == expected) return;
  throw std::invalid_argument(what + " has " + std::to_string(count) + " values; it must have " +
                              std::to_string(expected) + ", " + why);
}

void checkRange(const std::string& what, const char* list, const std::vector<double>& values, const Range& allowed) {
  for (std::size_t i = 0; i < values.size(); ++i) {
    atEntry(elementOf(list, i), [&] { allowed.require(what + elementOf(list, i), values[i]); });
  }
}

/// Starts at 0 and ascends.
void checkAscending(const std::string& what, const char* list, const std::vector<double>& values,
                    const Range& allowed) {
  checkRange(what, list, values, allowed);
  for (std::size_t i = 0; i < values.size(); ++i) {
    atEntry(elementOf(list, i), [&] {
      const std::string name = what + elementOf(list, i);
      if (i == 0 && values[0] != 0.0) throwBadValue(name, values[0], allowed.unit, "0; begin the table at 0");
      if (i > 0 && !(values[i] > values[i - 1])) {
        throwBadValue(name, values[i], allowed.unit,
                      "> " + text(values[i - 1]) + "; it is not greater than the value before it; sort the table");
      }
    });
  }
}

void checkScalarCoefficients(const std::string& what, const FrictionLawDescription& law) {
  checkRange(what, "kinetic", law.kinetic_coefficients, FrictionLawDescription::kCoefficients);
  checkRange(what, "static", law.static_coefficients, FrictionLawDescription::kCoefficients);
  for (std::size_t i = 0; i < law.kinetic_coefficients.size(); ++i) {
    if (law.static_coefficients[i] >= law.kinetic_coefficients[i]) continue;
    // The one coefficient of an isotropic law is no list in a scene.
    atEntry(law.kind == Kind::kIsotropic ? "static" : elementOf("static", i), [&] {
      throwBadValue(what + elementOf("static", i), law.static_coefficients[i], "",
                    ">= " + elementOf("kinetic", i) + " = " + text(law.kinetic_coefficients[i]) +
                        "; the static coefficient is smaller than the kinetic one; swap or equal them");
    });
  }
}

/// Of a symmetric matrix.
double smallerEigenvalue(const Matrix2& S) { return 0.5 * (S.trace() - std::hypot(S(0, 0) - S(1, 1), 2.0 * S(0, 1))); }

void checkDissipates(const std::string& what, const char* list, const std::vector<double>& m) {
  const Matrix2 M = frictionTensor(m);
  const double smaller = smallerEigenvalue(0.5 * (M + M.transpose()));
  if (smaller >= -kDecimalRoundOff * M.norm()) return;
  throwBadValue(
      what + "the smaller eigenvalue of the symmetric part of '" + list + "'", smaller, "",
      ">= 0, or else the tensor drives sliding in some direction; make the diagonal larger or the rest smaller");
}

/// Static friction must hold whatever kinetic friction can exert: {M_k d} inside {M_s d} for |d| <= 1. The larger set
/// has the larger support |M' x| in every direction x, so that M_s M_s' - M_k M_k' is positive semidefinite. (For
/// regular M_s the same as |M_s^-1 M_k| <= 1.)
void checkStaticHoldsKinetic(const std::string& what, const FrictionLawDescription& law) {
  const Matrix2 M_s = frictionTensor(law.static_coefficients);
  const Matrix2 M_k = frictionTensor(law.kinetic_coefficients);
  const Matrix2 S = M_s * M_s.transpose();
  const double smaller = smallerEigenvalue(S - M_k * M_k.transpose());
  if (smaller >= -kDecimalRoundOff * S.norm()) return;
  throwBadValue(what + "the smaller eigenvalue of S S' - K K', S 'static' and K 'kinetic',", smaller, "",
                ">= 0, or else static friction is below kinetic friction in some direction; make 'static' larger");
}

void checkTensor(const std::string& what, const FrictionLawDescription& law) {
  checkRange(what, "kinetic", law.kinetic_coefficients, FrictionLawDescription::kTensorEntries);
  checkRange(what, "static", law.static_coefficients, FrictionLawDescription::kTensorEntries);
  checkDissipates(what, "kinetic", law.kinetic_coefficients);
  checkStaticHoldsKinetic(what, law);
}

}  // namespace

void checkFrictionLaw(const FrictionLawDescription& law) {
  const std::string what = std::string(nameOf(law.kind, kFrictionLawNames, "friction law")) + " friction: ";
  if (law.kind == Kind::kTable) {
    if (law.angles_rad.empty())
      throw std::invalid_argument(what + "angles_rad is empty; it must have at least 1 value, 0");
    checkAscending(what, "angles_rad", law.angles_rad, FrictionLawDescription::kAngles);
  }
  const char* why = law.kind == Kind::kTable ? "one per angle" : "as many as this law has coefficients";
  checkCount(what + "static", law.static_coefficients.size(), expectedCount(law), why);
  checkCount(what + "kinetic", law.kinetic_coefficients.size(), expectedCount(law), why);
  if (law.kind == Kind::kTensor) {
    checkTensor(what, law);
  } else {
    checkScalarCoefficients(what, law);
  }
  checkCount(what + "speed_factors", law.speed_factors.size(), law.speeds_m_per_s.size(), "one per speed");
  checkAscending(what, "speeds_m_per_s", law.speeds_m_per_s, FrictionLawDescription::kSpeeds);
  checkRange(what, "speed_factors", law.speed_factors, FrictionLawDescription::kSpeedFactors);
  checkCount(what + "pressure_factors", law.pressure_factors.size(), law.pressures_pa.size(), "one per pressure");
  checkAscending(what, "pressures_pa", law.pressures_pa, FrictionLawDescription::kPressures);
  checkRange(what, "pressure_factors", law.pressure_factors, FrictionLawDescription::kPressureFactors);
}

}  // namespace tissue_contact
