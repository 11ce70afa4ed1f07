/// @file
/// Room `baselines`, private: the natural map of Coulomb friction, whose zeros are the answers of a contact. Impulse and
/// velocity of one contact in (contact frame n, t1, t2); how far they are from the law out.
///
///   F(r, u) = r - P_K(r - u - mu |u_t| n),   K = { |r_t| <= mu r_n }   (De Saxce & Feng 1998)
#pragma once

#include "tissue_contact/baselines/delassus.h"

namespace tissue_contact {

/// The point of the cone |x_t| <= mu x_n nearest to x.
Vector3 projectOntoCone(const Vector3& x, double mu);

/// A generalised derivative of projectOntoCone at x.
Matrix3 coneProjectionDerivative(const Vector3& x, double mu);

/// F. Impulse and velocity in units that make them comparable (NaturalUnits).
Vector3 naturalMap(const Vector3& r, const Vector3& u, double mu);

/// The units of the scaled natural map: r' = r / impulse, u' = u / velocity, so that W' = W impulse / velocity has a
/// diagonal of 1 on average.
struct NaturalUnits {
  double impulse = 1.0;   ///< N s
  double velocity = 1.0;  ///< m/s
};
NaturalUnits naturalUnits(const DelassusProblem& problem);

/// DelassusResiduals::scaled_natural_map.
/// @param u W r + q, m/s.
double scaledNaturalMap(const DelassusProblem& problem, const VectorX& r, const VectorX& u);

}  // namespace tissue_contact
