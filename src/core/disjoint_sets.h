/// @file
/// Room `core`, private: disjoint sets of indices that are joined one pair after the other (union-find with path halving).
#pragma once

#include <algorithm>
#include <cstddef>
#include <numeric>
#include <vector>

namespace tissue_contact {

class DisjointSets {
 public:
  /// Each index by itself.
  explicit DisjointSets(std::size_t count) : towards_(count) { std::iota(towards_.begin(), towards_.end(), 0); }

  /// The least index of a set.
  int first(int index) {
    while (towards(index) != index) index = towards(index) = towards(towards(index));
    return index;
  }

  void join(int a, int b) {
    const int one = first(a);
    const int other = first(b);
    towards(std::max(one, other)) = std::min(one, other);
  }

 private:
  int& towards(int index) { return towards_[static_cast<std::size_t>(index)]; }

  std::vector<int> towards_;  ///< another index of the set, or itself: the first
};

}  // namespace tissue_contact
