/// @file
/// Room `mesh`, private: what is to be told of a shell's mesh that can be used and is perhaps not what was meant.
#pragma once

#include <string>
#include <vector>

#include "tissue_contact/mesh/triangle_mesh.h"

namespace tissue_contact {

/// Nodes of its border that lie beside others and are not joined with them (findNearNodes()), with a place, m; parts that share no node. A sentence
/// each. @pre checkSheetMesh().
std::vector<std::string> shellNotes(const TriangleMesh& mesh);

}  // namespace tissue_contact
