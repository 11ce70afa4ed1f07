/// @file
/// Room `validation`: where this package's own scenes and robots are.
#pragma once

#include <string>

namespace tissue_contact {

/// The directory that holds `config/` and `urdf/`: the install space's share directory when the running program lies in
/// one, else the source tree it was built from.
std::string packageDirectory();

}  // namespace tissue_contact
