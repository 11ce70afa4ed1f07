/// @file
/// Room `simulation`: where forces of a contact act.
#pragma once

#include <cstddef>
#include <vector>

#include "tissue_contact/contact/contact.h"
#include "tissue_contact/tissue/tissue.h"

namespace tissue_contact {

/// Where the surface of the tissue meets what touches it, m, world frame: Contact::p_WC, or of a sheet or shell,
/// whose p_WC is in its middle surface, half its thickness before it. Forces act on the instrument here: at p_WC
/// their moment about the middle of a ball of radius R was 1 + t / (2 R) times that of forces at its surface.
inline Vector3 touchedPoint(const Contact& contact, const std::vector<Tissue>& tissues) {
  const double thickness = tissues[static_cast<std::size_t>(contact.key.tissue)].thickness();
  return contact.p_WC - 0.5 * thickness * contact.R_WC.col(0);
}

}  // namespace tissue_contact
