/// @file
/// Room `friction`: laws whose friction depends on the direction of sliding, behind one small interface, and the exact
/// answer of a single contact that obeys one. A law's numbers in; friction force per unit normal force out.
///
/// A law says two things in its own axes (axis 1, axis 2 of the contact plane):
///  - the force that opposes sliding along a unit direction d, per unit normal force: f(d), with f(d) . d <= 0;
///  - which tangential forces static friction can hold: those with staticUse(f) <= 1.
/// Sources: orthotropic ellipse with the associated rule, f = -(mu1^2 d1, mu2^2 d2) / sqrt(mu1^2 d1^2 + mu2^2 d2^2)
/// (Zmitrowicz, "Mathematical descriptions of anisotropic friction", IJSS 25, 1989); friction tensors, f = -M d (Pabst,
/// Thomaszewski & Strasser, "Anisotropic friction for deformable surfaces and solids", SCA 2009).
#pragma once

#include <memory>

#include "tissue_contact/core/types.h"
#include "tissue_contact/friction/coulomb.h"
#include "tissue_contact/scene/scene.h"

namespace tissue_contact {

/// Const after construction.
class AnisotropicFriction {
 public:
  virtual ~AnisotropicFriction() = default;

  /// Kinetic friction force per unit normal force while sliding along the unit vector d. Dissipative: result . d <= 0.
  virtual Vector2 slidingForce(const Vector2& d) const = 0;

  /// The share of its limit that a tangential force per unit normal force uses: it is held while this is <= 1.
  /// Positively homogeneous in f; infinite where the limit is 0. `kinetic`: the limit a contact that was sliding must
  /// stay within to stick again.
  virtual double use(const Vector2& f, bool kinetic) const = 0;
};

/// The law the numbers describe; null for an isotropic one.
/// @throws std::invalid_argument naming the coefficient, its value and the allowed range: a wrong number of
/// coefficients, one that is negative or not finite, static below kinetic, a table whose angles do not ascend from 0 to
/// below 2 pi, a tensor that would drive sliding, a speed table that does not ascend or leaves 0 to 1.
std::unique_ptr<const AnisotropicFriction> makeAnisotropicFriction(const FrictionLawDescription& law);

/// Stribeck factor of a law at a sliding speed (m/s): 1 without a table.
double kineticFactor(const FrictionLawDescription& law, double speed_m_per_s);

/// As solveCoulombContact, for law.anisotropic: static while the sticking impulse is within the limit; else sliding with
/// r_t = r_n f(d), u_t = s d, s > 0, u_n = 0. Several directions can be consistent where a law is not associated: the one
/// nearest to the direction in which the contact would slide without friction is taken.
ContactAnswer solveAnisotropicContact(const Matrix3& W, const Vector3& q, const CoulombLaw& law, bool was_sliding);

}  // namespace tissue_contact
