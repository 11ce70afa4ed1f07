/// @file
/// Room `friction`: laws whose friction depends on the direction of sliding, behind one small interface, and the exact
/// answer of a single contact that obeys one. A law's numbers in; friction force per unit normal force out.
///
/// A law speaks of the instrument: d is the unit direction in which it slides over the tissue, f the friction the
/// tissue exerts on it per unit normal force, both in the law's own axes (axis 1, axis 2 = n x axis 1). It says two
/// things:
///  - the force that opposes sliding along d: f(d), with f(d) . d <= 0;
///  - which forces static friction can hold: those with use(f) <= 1.
/// The contact frame counts the other way round (u: tissue relative to instrument; r: impulse on the tissue), so there
/// sliding is -d and friction -f, turned into (t1, t2); kineticFriction and frictionUse below take care of that.
/// Sources: orthotropic ellipse with the associated rule, f = -(mu1^2 d1, mu2^2 d2) / sqrt(mu1^2 d1^2 + mu2^2 d2^2)
/// (Zmitrowicz, "Mathematical descriptions of anisotropic friction", IJSS 25, 1989); friction tensors, f = -M d (Pabst,
/// Thomaszewski & Strasser, "Anisotropic friction for deformable surfaces and solids", SCA 2009).
#pragma once

#include <memory>

#include "tissue_contact/core/types.h"
#include "tissue_contact/friction/coulomb.h"
#include "tissue_contact/friction/friction_law_description.h"

namespace tissue_contact {

/// Const after construction.
class AnisotropicFriction {
 public:
  virtual ~AnisotropicFriction() = default;

  /// Kinetic friction on the instrument per unit normal force while it slides along the unit vector d. Dissipative:
  /// result . d <= 0.
  virtual Vector2 slidingForce(const Vector2& d) const = 0;

  /// The share of its limit that a tangential force on the instrument, per unit normal force, uses: it is held while
  /// this is <= 1. Positively homogeneous in f; infinite where the limit is 0 (up to round-off, 1e-13 of the law's
  /// largest coefficient). `kinetic`: the limit a contact that was sliding must stay within to stick again; static
  /// friction holds everything within it.
  virtual double use(const Vector2& f, bool kinetic) const = 0;

  /// (r_n, r_t1, r_t2) of a contact that slides; see solveAnisotropicContact. W and q are those of the instrument
  /// relative to the tissue, in (n, axis 1, axis 2); q_n < 0 and the sticking impulse outside the kinetic limit.
  /// @param W compliance, 1/kg.
  /// @param q velocity, m/s.
  /// @param factor the kinetic friction is multiplied by this.
  virtual Vector3 slidingImpulse(const Matrix3& W, const Vector3& q, double factor) const = 0;
};

/// The law the numbers describe; null for an isotropic one (whose numbers are checked all the same).
/// @throws std::invalid_argument naming the coefficient (by its key in scene files), its value and the allowed range: a
/// wrong number of coefficients, one that is negative, above 1e6 or not finite, static below kinetic in any direction,
/// a table whose angles do not ascend from 0 to below 2 pi, a tensor that would drive sliding, a speed or pressure table
/// that does not ascend from 0 or whose factors leave 0 to 1 (pressure: 0 to 10).
std::unique_ptr<const AnisotropicFriction> makeAnisotropicFriction(const FrictionLawDescription& law);

/// Stribeck factor of a law at a sliding speed (m/s): 1 without a table.
double kineticFactor(const FrictionLawDescription& law, double speed_m_per_s);

/// Factor of a law's static and kinetic friction at a contact pressure (Pa): 1 without a table.
double pressureFactor(const FrictionLawDescription& law, double pressure_pa);

/// Kinetic friction on the tissue per unit normal force, in (t1, t2), while u_t points along the unit vector
/// `direction`; any law. A law may allow more than one where its limit is flat (see solveAnisotropicContact).
Vector2 kineticFriction(const CoulombLaw& law, const Vector2& direction);

/// The share of its limit that a tangential impulse r_t on the tissue uses at normal impulse 1, in (t1, t2); any law.
/// It scales with r_t: held while frictionUse(law, r_t, kinetic) <= r_n. Infinite where the limit is 0.
double frictionUse(const CoulombLaw& law, const Vector2& r_t, bool kinetic);

/// As solveCoulombContact, for law.anisotropic: static while the sticking impulse is within the limit; else sliding
/// with u_n = 0, u_t = s d, s > 0 and r_t = r_n kineticFriction(d). Where friction jumps with the direction (a law
/// without friction along one axis, while sliding along it) r_t lies between its values on both sides, so that sliding
/// keeps to that direction. One unknown, an angle: Newton's iteration from the direction of frictionless sliding; if
/// that fails, directions all around are tried from there and a bracket is bisected. For W symmetric positive definite
/// there is always an answer; friction that is not associated, or strongly coupled to the normal, can leave several,
/// and the one found first counts. Exact up to round-off; no allocation; bounded work, in practice 2 to 4 evaluations
/// of the law.
ContactAnswer solveAnisotropicContact(const Matrix3& W, const Vector3& q, const CoulombLaw& law, bool was_sliding);

}  // namespace tissue_contact
