/// @file
/// Room `friction`: Coulomb friction of one contact with a static and a kinetic coefficient.
#pragma once

namespace tissue_contact {

/// What a contact is doing. Open: no impulse. Static: held, no sliding. Kinetic: sliding.
enum class ContactState { kOpen, kStatic, kKinetic };

/// Isotropic Coulomb law; both 0: frictionless.
struct CoulombLaw {
  double mu_static = 0.0;   ///< >= mu_kinetic
  double mu_kinetic = 0.0;  ///< >= 0
};

}  // namespace tissue_contact
