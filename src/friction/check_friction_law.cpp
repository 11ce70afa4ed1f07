#include "friction/check_friction_law.h"

#include <cmath>
#include <string>

#include "tissue_contact/core/check.h"

namespace tissue_contact {
namespace {

using Kind = FrictionLawDescription::Kind;

/// Keeps squares of coefficients finite; dry friction seldom passes 2.
constexpr double kLargestCoefficient = 1e6;

/// Round-off of typed decimals, as a share of the size of a matrix.
constexpr double kRoundOff = 1e-12;

std::string element(const char* list, std::size_t i) { return std::string(list) + "[" + std::to_string(i) + "]"; }

std::string text(double value) {
  std::ostringstream stream;
  stream.precision(std::numeric_limits<double>::max_digits10);
  stream << value;
  return stream.str();
}

const char* kindName(Kind kind) {
  switch (kind) {
    case Kind::kIsotropic:
      return "isotropic friction: ";
    case Kind::kOrthotropic:
      return "orthotropic friction: ";
    case Kind::kAsymmetric:
      return "asymmetric friction: ";
    case Kind::kTable:
      return "friction table: ";
    case Kind::kTensor:
      return "friction tensor: ";
  }
  return "";
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

void checkRange(const std::string& what, double value, double low, double high, const char* unit = "") {
  if (!(value >= low && value <= high)) throwBadValue(what, value, unit, text(low) + " to " + text(high));
}

/// Starts at 0 and ascends.
void checkAscending(const std::string& what, const char* list, const std::vector<double>& values, const char* unit) {
  for (std::size_t i = 0; i < values.size(); ++i) {
    const std::string name = what + element(list, i);
    if (!std::isfinite(values[i])) throwBadValue(name, values[i], unit, "finite");
    if (i == 0 && values[0] != 0.0) throwBadValue(name, values[0], unit, "0: the list starts there");
    if (i > 0 && !(values[i] > values[i - 1])) {
      throwBadValue(name, values[i], unit, "> " + text(values[i - 1]) + ", the value before it");
    }
  }
}

void checkAngles(const std::string& what, const std::vector<double>& angles) {
  if (angles.empty()) throw std::invalid_argument(what + "angles_rad is empty; it must have at least 1 value, 0");
  checkAscending(what, "angles_rad", angles, "rad");
  if (!(angles.back() < 2.0 * M_PI)) {
    throwBadValue(what + element("angles_rad", angles.size() - 1), angles.back(), "rad",
                  "< 2 pi: the table closes by itself");
  }
}

void checkScalarCoefficients(const std::string& what, const FrictionLawDescription& law) {
  for (std::size_t i = 0; i < law.kinetic_coefficients.size(); ++i) {
    const double mu_kinetic = law.kinetic_coefficients[i];
    const double mu_static = law.static_coefficients[i];
    checkRange(what + element("kinetic", i), mu_kinetic, 0.0, kLargestCoefficient);
    checkRange(what + element("static", i), mu_static, 0.0, kLargestCoefficient);
    if (!(mu_static >= mu_kinetic)) {
      throwBadValue(what + element("static", i), mu_static, "",
                    ">= " + element("kinetic", i) + " = " + text(mu_kinetic));
    }
  }
}

/// Of a symmetric matrix.
double smallerEigenvalue(const Matrix2& S) { return 0.5 * (S.trace() - std::hypot(S(0, 0) - S(1, 1), 2.0 * S(0, 1))); }

void checkDissipates(const std::string& what, const char* list, const std::vector<double>& m) {
  const Matrix2 M = frictionTensor(m);
  const double smaller = smallerEigenvalue(0.5 * (M + M.transpose()));
  if (smaller >= -kRoundOff * M.norm()) return;
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
  if (smaller >= -kRoundOff * S.norm()) return;
  throwBadValue(what + "the smaller eigenvalue of S S' - K K', S 'static' and K 'kinetic',", smaller, "",
                ">= 0, or else static friction is below kinetic friction in some direction; make 'static' larger");
}

void checkTensor(const std::string& what, const FrictionLawDescription& law) {
  for (std::size_t i = 0; i < 4; ++i) {
    checkRange(what + element("kinetic", i), law.kinetic_coefficients[i], -kLargestCoefficient, kLargestCoefficient);
    checkRange(what + element("static", i), law.static_coefficients[i], -kLargestCoefficient, kLargestCoefficient);
  }
  checkDissipates(what, "kinetic", law.kinetic_coefficients);
  checkStaticHoldsKinetic(what, law);
}

void checkSpeeds(const std::string& what, const FrictionLawDescription& law) {
  checkCount(what + "speed_factors", law.speed_factors.size(), law.speeds_m_per_s.size(), "one per speed");
  checkAscending(what, "speeds_m_per_s", law.speeds_m_per_s, "m/s");
  for (std::size_t i = 0; i < law.speed_factors.size(); ++i) {
    checkRange(what + element("speed_factors", i), law.speed_factors[i], 0.0, 1.0);
  }
}

}  // namespace

void checkFrictionLaw(const FrictionLawDescription& law) {
  const std::string what = kindName(law.kind);
  if (law.kind == Kind::kTable) checkAngles(what, law.angles_rad);
  const char* why = law.kind == Kind::kTable ? "one per angle" : "as many as this law has coefficients";
  checkCount(what + "static", law.static_coefficients.size(), expectedCount(law), why);
  checkCount(what + "kinetic", law.kinetic_coefficients.size(), expectedCount(law), why);
  if (law.kind == Kind::kTensor) {
    checkTensor(what, law);
  } else {
    checkScalarCoefficients(what, law);
  }
  checkSpeeds(what, law);
}

}  // namespace tissue_contact
