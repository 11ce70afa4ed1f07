/// @file
/// Room `friction`: a friction law as numbers.
#pragma once

#include <utility>
#include <vector>

#include "tissue_contact/core/range.h"
#include "tissue_contact/core/types.h"

namespace tissue_contact {

/// A dry-friction law as numbers: what friction opposes sliding in each direction of the contact plane. Directions are
/// those in which the INSTRUMENT slides over the tissue (the opposite of the tissue's velocity relative to the
/// instrument), as angles from the law's axis 1 towards axis 2; axis 2 = n x axis 1, n from the instrument into the
/// tissue. So "forward" of a jaw with an asymmetric law is the jaw moving along its own +axis 1 over the tissue, and
/// with axis 1 along the fibre it is the instrument moving along +fibre. The force the instrument feels opposes that
/// motion. Of two tissues, the one n points away from takes the instrument's part.
struct FrictionLawDescription {
  enum class Kind {
    kIsotropic,    ///< coefficients: mu
    kOrthotropic,  ///< mu along axis 1, mu along axis 2: elliptic limit, force not collinear with sliding
    kAsymmetric,   ///< mu sliding along +axis 1, mu along -axis 1, mu along axis 2: quarter ellipses, force as above
    kTable,  ///< mu at each of `angles_rad` of the sliding direction, linear in between, periodic; force collinear
    kTensor  ///< m11, m12, m21, m22: force = -M d, d the sliding direction; sym(M) must be positive semidefinite
  };
  enum class Axis {
    kNone,  ///< isotropic laws
    kLink,  ///< `link_axis` turns with the instrument link
    kFibre  ///< the tissue's fibre direction, carried by its deformation
  };
  static constexpr Range kCoefficients{0.0, 1e6};  ///< keeps their squares finite; dry friction seldom passes 2
  static constexpr Range kTensorEntries{-1e6, 1e6};
  static constexpr Range kAngles{0.0, 6.283185307179586, "rad", "give radians, >= 0 and < 2 pi", false, true};
  static constexpr Range kSpeeds{0.0, 1000.0, "m/s"};
  static constexpr Range kSpeedFactors{0.0, 1.0, "", "kinetic friction must not exceed the static one"};
  static constexpr Range kPressures{0.0, 1e9, "Pa"};
  static constexpr Range kPressureFactors{0.0, 10.0};

  Kind kind = Kind::kIsotropic;
  std::vector<double> static_coefficients;   ///< nowhere below the kinetic ones
  std::vector<double> kinetic_coefficients;  ///< same number
  std::vector<double> angles_rad;            ///< kTable: ascending, from 0, below 2 pi
  Axis axis = Axis::kNone;
  Vector3 link_axis = Vector3::UnitX();  ///< axis 1 in the link's frame, projected into the contact plane
  /// Stribeck: kinetic coefficients are multiplied by a factor that depends on sliding speed, linear in between, held
  /// beyond the ends. Empty: 1 at every speed.
  std::vector<double> speeds_m_per_s;  ///< ascending, from 0
  std::vector<double> speed_factors;   ///< 0 to 1: kinetic friction never exceeds static
  /// Static and kinetic coefficients are multiplied by a factor that depends on the contact pressure, linear in between,
  /// held beyond the ends. Empty: 1 at every pressure.
  std::vector<double> pressures_pa;      ///< ascending, from 0
  std::vector<double> pressure_factors;  ///< 0 to 10: with coefficients of 1 they are the coefficients themselves
};

/// As scene files and messages have them.
constexpr std::pair<const char*, FrictionLawDescription::Kind> kFrictionLawNames[] = {
    {"isotropic", FrictionLawDescription::Kind::kIsotropic},
    {"orthotropic", FrictionLawDescription::Kind::kOrthotropic},
    {"asymmetric", FrictionLawDescription::Kind::kAsymmetric},
    {"table", FrictionLawDescription::Kind::kTable},
    {"tensor", FrictionLawDescription::Kind::kTensor}};

}  // namespace tissue_contact
