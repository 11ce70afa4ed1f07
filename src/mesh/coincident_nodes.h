/// @file
/// Room `mesh`, private: nodes of a volume mesh that lie in one place, so that the elements around it do not hang together there: what is
/// written element by element, parts that were meshed one by one, a cut.
#pragma once

#include <vector>

#include "tissue_contact/core/types.h"

namespace tissue_contact {

/// For each node the first used one that lies where it does (within kMergeDistance of the diagonal of the box around those used); for a node
/// that is not used itself.
/// @pre `used` has an entry for each node.
std::vector<int> firstInPlace(const std::vector<Vector3>& nodes, const std::vector<bool>& used);

}  // namespace tissue_contact
