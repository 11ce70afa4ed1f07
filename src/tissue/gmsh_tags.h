/// @file
/// Room `tissue`, private: from the node tags of a Gmsh file (sparse, in any order) to node indices in file order.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "tissue/mesh_file_cursor.h"

namespace tissue_contact {

/// Sorted pairs, not a table by tag: memory follows the number of nodes, whatever the largest tag.
class GmshTags {
 public:
  void reserve(std::size_t count) { indices_.reserve(count); }

  /// The next node in file order has this tag. @throws std::invalid_argument for a negative tag.
  void add(std::int64_t tag, const MeshFileCursor& in);

  /// To be called once all tags are added. @throws std::invalid_argument naming a tag that two nodes share.
  void finish(const MeshFileCursor& in);

  /// Index of the node with this tag, or -1.
  int find(std::int64_t tag) const;

 private:
  std::vector<std::pair<std::int64_t, int>> indices_;
};

}  // namespace tissue_contact
