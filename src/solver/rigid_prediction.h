/// @file
/// Room `solver`, private: where sweeps begin for a body that static contacts carry. Contact problem and warm start in, a better warm start out.
#pragma once

#include "tissue_contact/solver/contact_problem.h"

namespace tissue_contact {

/// Adds to the velocities of each body without fixed nodes the rigid motion with which its static contacts (ContactRow::was_static) go on with
/// their instruments as nearly as they can (least squares; the least turning where they leave it open). A body that its instrument carries
/// mostly moves as one, and sweeps pass a change of that on from node to node: in a stiff body by so little that contacts which bear next to
/// nothing were beyond their limit until hundreds of sweeps had been made (doc/notes/method.md).
///
/// Not where that would take more than the impulses with which those contacts press: an organ that is touched in one place. Bodies without x are
/// left alone, and so are contacts between tissues. Answers of steps that are solved depend on it within the tolerance only.
void predictRigidMotions(const ContactProblem& problem, ContactSolution& solution);

}  // namespace tissue_contact
