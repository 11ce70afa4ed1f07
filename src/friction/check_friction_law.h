/// @file
/// Room `friction`, private: are the numbers of a friction law sound? Names of coefficients in messages are the keys of
/// scene files.
#pragma once

#include "tissue_contact/core/types.h"
#include "tissue_contact/friction/friction_law_description.h"

namespace tissue_contact {

/// @throws EntryError of an entry of the law ("angles_rad[2]") as makeAnisotropicFriction says.
void checkFrictionLaw(const FrictionLawDescription& law);

/// Coefficients m11, m12, m21, m22 as a matrix.
inline Matrix2 frictionTensor(const std::vector<double>& m) {
  Matrix2 M;
  M << m[0], m[1], m[2], m[3];
  return M;
}

}  // namespace tissue_contact
