/// @file
/// Room `baselines`, private: solvers of a step that do not share the predictor-corrector's loop.
#pragma once

#include <memory>

#include "tissue_contact/baselines/solver_description.h"
#include "tissue_contact/solver/contact_solver.h"

namespace tissue_contact {

/// Solvers that work on the Delassus matrix (reference, static condensation). Exact and slow: every step factors A and
/// fills W. They measure the error of the others.
std::unique_ptr<ContactSolver> makeDelassusStepSolver(const SolverDescription& description);

/// The rival that treats friction after the step: a frictionless solve, then one friction impulse per contact on the
/// velocities it left (Bridson, Fedkiw & Anderson, "Robust treatment of collisions, contact and friction for cloth
/// animation", SIGGRAPH 2002, section 7.2, with the effective mass of the contact's nodes alone). The impulses never
/// meet the elastic forces of the step, so A v = b + J'lambda holds no longer.
std::unique_ptr<ContactSolver> makeImpulseFriction(const SolverOptions& options, const SecondsClock& clock);

}  // namespace tissue_contact
