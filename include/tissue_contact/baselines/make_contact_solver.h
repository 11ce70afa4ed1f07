/// @file
/// Room `baselines`: a solver by its description.
#pragma once

#include <memory>

#include "tissue_contact/baselines/solver_description.h"
#include "tissue_contact/solver/contact_solver.h"

namespace tissue_contact {

/// The solver a scene asks for.
/// @param clock needed for a time budget only.
/// @throws std::invalid_argument as requireSolver.
std::unique_ptr<ContactSolver> makeContactSolver(const SolverDescription& description,
                                                 const SecondsClock& clock = nullptr);

}  // namespace tissue_contact
