/// @file
/// Room `solver`: how far an answer is from the contact problem, computed on the final velocities and impulses.
#pragma once

#include "tissue_contact/solver/contact_problem.h"

namespace tissue_contact {

/// Worst values over all contacts of one step.
struct Residuals {
  /// |A v - b - J'lambda| / |J'lambda|, dimensionless; without contact over the load and the tissues' weight of one
  /// step, so that 1 is an unbalanced force as large as these.
  double momentum = 0.0;
  double momentum_defect_n_s = 0.0;  ///< |A v - b - J'lambda|, N s
  /// Its sum over the nodes of a body, N s: magnitudes added over the bodies that a contact presses or pulls.
  double net_defect_n_s = 0.0;
  double penetration_m =
      0.0;  ///< how deep the linearised gap at the end of the step is below 0, and below what squeezes a sheet, m
  double adhesion_n = 0.0;           ///< pulling normal force, N
  double complementarity_w = 0.0;    ///< normal force times separation speed, likewise, W
  double cone_violation_n = 0.0;     ///< tangential force beyond its limit, N
  double static_slip_m_per_s = 0.0;  ///< sliding speed of contacts called static, m/s
  double kinetic_angle_rad = 0.0;    ///< between friction force and the opposite of sliding, over sliding contacts, rad
};

/// |b| over all bodies that are awake, and the momentum of their nodes at a nanometre per second, N s. The latter is
/// beyond measure, but keeps the round-off of a tissue at rest from being solved to the tolerance.
double loadScale(const ContactProblem& problem);

/// @param scratch one nodal vector per body; overwritten, allocates only where the sizes change.
Residuals computeResiduals(const ContactProblem& problem, const ContactSolution& solution,
                           std::vector<NodalVectors>& scratch);

}  // namespace tissue_contact
