/// @file
/// Room `simulation`: what the choice of the elastic law does to the forces of a press. Strain under the tool in; the likely error of
/// the force out.
#pragma once

#include "tissue_contact/core/types.h"
#include "tissue_contact/tissue/material_description.h"

namespace tissue_contact {

/// Von Mises' equivalent of Green's strain, sqrt(2/3 dev E : dev E), E = (F'F - I)/2: 0 for rotations and pure changes of volume, e for
/// a small uniaxial strain e at constant volume.
double equivalentStrain(const Matrix3& F);

/// Likely relative error of the force a tool meets on tissue of this law, against a neo-Hookean one of the same moduli, volume alone averaged over
/// patches in both (`dilatation: patch`, `distortion: element`); negative: too small; 0 for other laws than linear and corotational. Elements that do not
/// average are stiffer: their error is another.
///
/// a s + b (nu - .3) s + c s^2, fitted to presses of a sphere, some of which `tissue_contact_validate --case press-laws` repeats: depths of
/// .1 to .8 R, R 5 and 10 mm, cells of .16 to .8 R, nu .3 to .49 (others count as the nearest of these), volume alone averaged over patches; s up to
/// .4 (corotational) and .6 (linear), and beyond as there. It meets what was found within 6 % of the force, 2.2 % RMS. Why it has this
/// shape: at large strain the neo-Hookean law stiffens, laws linear in the stretch do not; the less a tissue gives way in volume, the more
/// of a press is shear. The linear law also takes rotation for strain, which stiffens it. For blunt tools that press; drawing, shearing
/// and edges are not what it was fitted to.
/// @param strain the mean over the contacts, by force, of equivalentStrain() of the elements around.
double likelyLawError(ElasticModel model, double poissons_ratio, double strain);

/// Whether likelyLawError() knows this law.
inline bool hasRange(ElasticModel model) {
  return model == ElasticModel::kLinear || model == ElasticModel::kCorotational;
}

/// Tells once when the law leaves its range, kLeft, and again only after it has been within kBack.
class LawAlarm {
 public:
  static constexpr double kLeft = 0.05;  ///< of the force: what other errors of a coarse mesh amount to
  static constexpr double kBack = 0.025;

  /// @param relative error of the force.
  /// @return whether the law leaves its range with it.
  bool leaves(double relative);

 private:
  bool outside_ = false;
};

}  // namespace tissue_contact
