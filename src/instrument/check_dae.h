/// @file
/// Room `instrument` (private): guards assimp's Collada reader against files that would crash or stall it.
#pragma once

#include <string>

namespace tissue_contact {

/// assimp 5.2 expands <instance_node> recursively: a node that contains itself overflows the stack, and nodes that each
/// contain two copies of the next take for ever. This walks the same expansion with limits on its depth and size.
/// @param xml content of the DAE file. @throws std::invalid_argument naming `source`, the line or the node at fault.
void checkDae(const std::string& xml, const std::string& source);

}  // namespace tissue_contact
