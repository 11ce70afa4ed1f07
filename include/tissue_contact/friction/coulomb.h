/// @file
/// Room `friction`: Coulomb friction of one contact with a static and a kinetic coefficient, and the exact answer of a
/// single contact: the corrector that the iteration applies contact by contact.
#pragma once

#include "tissue_contact/core/types.h"

namespace tissue_contact {

/// What a contact is doing. Open: no impulse. Static: held, no sliding. Kinetic: sliding (or frictionless).
enum class ContactState { kOpen, kStatic, kKinetic };

class AnisotropicFriction;

/// The friction of one contact: isotropic by two coefficients (both 0: frictionless), or an anisotropic law in their
/// place.
struct CoulombLaw {
  double mu_static = 0.0;                            ///< >= mu_kinetic
  double mu_kinetic = 0.0;                           ///< >= 0
  const AnisotropicFriction* anisotropic = nullptr;  ///< replaces both coefficients; see friction_law.h
  Vector2 axis = Vector2::UnitX();                   ///< anisotropic: unit, the law's axis 1 in (t1, t2)
  double static_factor = 1.0;   ///< anisotropic: times its static friction (contact pressure), >= 0
  double kinetic_factor = 1.0;  ///< anisotropic: times its kinetic friction (pressure and speed), 0 to static_factor
};

/// Impulse in the contact frame (n, t1, t2), N s, acting on the tissue, and the state it belongs to.
struct ContactAnswer {
  Vector3 impulse = Vector3::Zero();
  ContactState state = ContactState::kOpen;
};

/// Solves one contact: u = W r + q with 0 <= r_n  _|_  u_n >= 0 and
///   static:  u_t = 0 with |r_t| <= mu_stick r_n;   kinetic:  r_t = -mu_kinetic r_n u_t / |u_t|,
/// where mu_stick is mu_static, or mu_kinetic if the contact `was_sliding` (hysteresis: it re-sticks only if kinetic
/// friction is enough to stop it). Of a sliding contact the direction is the one unknown, found by Newton's iteration;
/// where friction is strongly coupled to the normal there can be several, and the one found first counts.
/// Sign: r_n >= 0 pushes the tissue away from the instrument, along n. Exact up to round-off; no allocation.
/// Anisotropic laws: see solveAnisotropicContact (friction_law.h), to which this hands over.
/// @param W 3x3 symmetric positive definite local compliance, 1/kg.
/// @param q velocity without this contact's impulse, m/s, with the gap's share gap/dt added to its normal component.
ContactAnswer solveCoulombContact(const Matrix3& W, const Vector3& q, const CoulombLaw& law, bool was_sliding);

/// Whether static friction holds more than kinetic friction anywhere.
bool holdsMoreAtRest(const CoulombLaw& law);

/// A contact that static friction holds as far as it can, for the time in which an iteration does not know yet whether that is enough: the
/// sticking impulse, or of its direction as much as the static limit allows (state kKinetic), with u_n = 0; what
/// would be torn off, or is shut by friction alone, as solveCoulombContact(). No answer of a step: what slides has kinetic friction. W, q and law as for solveCoulombContact().
ContactAnswer holdContact(const Matrix3& W, const Vector3& q, const CoulombLaw& law);

}  // namespace tissue_contact
