/// @file
/// Room `mesh`, private: the numbers by which a Gmsh file calls its nodes.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "mesh/reader/mesh_file_cursor.h"

namespace tissue_contact {

/// From the node tags of a file (sparse, in any order) to node indices in file order. Sorted pairs, not a table by tag: memory
/// follows the number of nodes, whatever the largest tag.
class NodeTags {
 public:
  void reserve(std::size_t count) { indices_.reserve(count); }

  /// The next node in file order has this tag.
  void add(std::int64_t tag, const MeshFileCursor& in) {
    if (tag < 0) in.fail("node tag " + std::to_string(tag) + " is negative; tags must be >= 0: export the mesh again");
    indices_.emplace_back(tag, static_cast<int>(indices_.size()));
  }

  /// To be called once all tags are added.
  void finish(const MeshFileCursor& in) {
    if (!std::is_sorted(indices_.begin(), indices_.end())) std::sort(indices_.begin(), indices_.end());
    const auto same = std::adjacent_find(indices_.begin(), indices_.end(),
                                         [](const auto& a, const auto& b) { return a.first == b.first; });
    if (same == indices_.end()) return;
    in.fail("nodes " + std::to_string(same->second) + " and " + std::to_string((same + 1)->second) +
            " (0-based, in file order) both have the tag " + std::to_string(same->first) +
            "; tags must be unique: export the mesh again");
  }

  /// Index of the node with this tag, or -1.
  int find(std::int64_t tag) const {
    const auto found = std::lower_bound(indices_.begin(), indices_.end(), std::make_pair(tag, -1));
    return found != indices_.end() && found->first == tag ? found->second : -1;
  }

 private:
  std::vector<std::pair<std::int64_t, int>> indices_;
};

}  // namespace tissue_contact
