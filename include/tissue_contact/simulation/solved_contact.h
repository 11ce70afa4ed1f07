/// @file
/// Room `simulation`: one contact of a step with its answer: what the simulator hands out, and what the contact that
/// continues it in the next step begins with.
#pragma once

#include "tissue_contact/contact/contact.h"
#include "tissue_contact/core/types.h"
#include "tissue_contact/friction/coulomb.h"

namespace tissue_contact {

struct SolvedContact {
  /// As detected at the start of the step, but for p_WC, which is that of its end, and the frame, turned to it where the point slid.
  Contact contact;
  ContactState state = ContactState::kOpen;
  Vector3 force_on_tissue_n =
      Vector3::Zero();  ///< lambda / dt in the world frame, N; the instrument feels the opposite
  /// How far the tissue slid over the instrument in the step, m, world frame. Of a static contact: what the solver has
  /// left over since it touched, which the next step takes back, so that a held contact does not creep.
  Vector3 slip_W = Vector3::Zero();
};

}  // namespace tissue_contact
