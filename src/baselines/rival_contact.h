/// @file
/// Room `baselines`, private: one contact under a linearised friction cone. Local compliance and velocity in; impulse and
/// state out. The rivals' replacements for solveCoulombContact. Isotropic laws only.
///
/// Both obey: u = W r + q with 0 <= r_n  _|_  u_n >= 0; static while the sticking impulse is inside mu_stick r_n times
/// the polygon (mu_stick: mu_kinetic under the `kinetic_limit`, else mu_static), otherwise the r_t of mu_kinetic r_n
/// times the polygon that dissipates most. The polygons are inscribed in the circle, so they never hold more than it
/// does. Wherever sliding is not straight towards a corner, r_t snaps to the nearest corner (direction off by up to pi
/// / sides) and a load towards the middle of a side is held less well (by 1 - cos(pi / sides): 29 % with 4 sides).
#pragma once

#include "solver/contact_corrector.h"
#include "tissue_contact/baselines/solver_description.h"

namespace tissue_contact {

/// The four-sided cone with two unknowns, one along the direction in which the contact slid before, one across it
/// (Otaduy, Tamstorf, Steinemann & Gross 2009): |r_1| + |r_2| <= mu r_n. Exact while the contact keeps sliding straight
/// on. Every combination of active sides is tried in closed form, so nothing iterates.
/// @param W 3x3 positive definite, 1/kg.
/// @param q velocity without this contact's impulse, m/s.
/// @param previous_sliding any length, m/s; zero: the axes are t1 and t2 of the contact frame.
ContactAnswer solveCone4Contact(const Matrix3& W, const Vector3& q, const CoulombLaw& law, bool kinetic_limit,
                                const Vector2& previous_sliding);

/// The cone with `sides` sides and first corner at t1, as an LCP in (r_n, beta_1 .. beta_sides, gamma) by Lemke's
/// method (Stewart & Trinkle 1996; Anitescu & Potra 1997). No heap allocation. If pivoting fails (not seen for positive
/// definite W) the contact keeps its frictionless impulse.
/// @param sides kMinConeSides to kMaxConeSides.
ContactAnswer solvePolyhedralContact(const Matrix3& W, const Vector3& q, const CoulombLaw& law, bool kinetic_limit,
                                     int sides);

/// r = G (r_n, beta_1 .. beta_sides): the normal and the corners of the polygon.
using ConeGenerators = Eigen::Matrix<double, 3, Eigen::Dynamic, 0, 3, kMaxConeSides + 1>;
ConeGenerators coneGenerators(int sides);

/// The conditions of that LCP which do not depend on W: gamma is the sliding speed, and sum beta <= mu r_n.
/// @param block of a contact's own unknowns in M, (sides + 2) x (sides + 2).
void setConeConditions(Eigen::Ref<Eigen::MatrixXd> block, double mu);

/// For ContactCorrector: the single-contact solver of kCone4 and kPolyhedral; empty for the others.
ContactRival rivalContactSolver(const SolverDescription& description);

}  // namespace tissue_contact
