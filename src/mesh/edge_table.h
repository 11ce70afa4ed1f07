/// @file
/// Room `mesh`, private: the edges of a triangle mesh: which triangles share one, which a triangle has.
#pragma once

#include <array>
#include <vector>

#include "tissue_contact/core/types.h"

namespace tissue_contact {

/// Side `side` of a triangle runs from its node `side` to the next.
struct EdgeUse {
  int triangle;
  int side;
  bool forward;  ///< from the smaller node index to the larger
};

/// Const after construction.
class EdgeTable {
 public:
  struct Edge {
    std::array<int, 2> nodes;  ///< ascending
    int first;                 ///< of its uses
    int count;
  };
  struct Uses {
    const EdgeUse* first;
    const EdgeUse* last;
    const EdgeUse* begin() const { return first; }
    const EdgeUse* end() const { return last; }
    int size() const { return static_cast<int>(last - first); }
    const EdgeUse& operator[](int i) const { return first[i]; }
  };

  /// @param triangles of three different nodes each.
  explicit EdgeTable(const std::vector<Triangle>& triangles);

  /// The edges, in ascending order of their nodes.
  std::vector<Edge>::const_iterator begin() const { return edges_.begin(); }
  std::vector<Edge>::const_iterator end() const { return edges_.end(); }
  std::size_t size() const { return edges_.size(); }
  const Edge& operator[](int i) const { return edges_[i]; }

  /// Null where a feature, as ContactKey names it, is no edge of this mesh.
  const Edge* find(const std::array<int, 3>& feature) const;

  /// The triangles beside an edge, ascending.
  Uses usesOf(const Edge& edge) const { return {&uses_[edge.first], &uses_[edge.first] + edge.count}; }
  /// Indices of a triangle's edges, by side.
  const std::array<int, 3>& edgesOf(int triangle) const { return edges_of_[triangle]; }

 private:
  std::vector<Edge> edges_;
  std::vector<EdgeUse> uses_;
  std::vector<std::array<int, 3>> edges_of_;
};

}  // namespace tissue_contact
