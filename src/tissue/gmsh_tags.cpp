/// @file
/// Room `tissue`: see gmsh_tags.h.
#include "tissue/gmsh_tags.h"

#include <algorithm>
#include <limits>
#include <string>

namespace tissue_contact {

void GmshTags::add(std::int64_t tag, const MeshFileCursor& in) {
  if (tag < 0) in.fail("node tag " + std::to_string(tag) + " is negative; tags must be >= 0: export the mesh again");
  indices_.emplace_back(tag, static_cast<int>(indices_.size()));
}

void GmshTags::finish(const MeshFileCursor& in) {
  if (!std::is_sorted(indices_.begin(), indices_.end())) std::sort(indices_.begin(), indices_.end());
  const auto same = std::adjacent_find(indices_.begin(), indices_.end(),
                                       [](const auto& a, const auto& b) { return a.first == b.first; });
  if (same == indices_.end()) return;
  in.fail("nodes " + std::to_string(same->second) + " and " + std::to_string((same + 1)->second) +
          " (0-based, in file order) both have the tag " + std::to_string(same->first) +
          "; tags must be unique: export the mesh again");
}

int GmshTags::find(std::int64_t tag) const {
  const auto found = std::lower_bound(indices_.begin(), indices_.end(), std::make_pair(tag, -1));
  return found != indices_.end() && found->first == tag ? found->second : -1;
}

}  // namespace tissue_contact
