/// @file
/// Room `mesh`: which program gmsh fills surfaces here. What is filled depends on it.
#pragma once

#include <string>

namespace tissue_contact {

/// What `gmsh --version` says.
/// @throws std::invalid_argument when there is none, with how to install it.
std::string gmshVersion();

}  // namespace tissue_contact
