/// @file
/// Room `ros`: what tissue_contact_node says of itself without a master.
#pragma once

#include <string>

namespace tissue_contact {

/// Whether an argument is --help or -h. Remappings and parameters (`name:=value`) never are.
bool asksForHelp(int argc, const char* const* argv);

/// What --help prints: parameters, topics, an example.
std::string nodeUsage();

}  // namespace tissue_contact
