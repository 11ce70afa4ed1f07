/// @file
/// Room `mesh`, private: checks that meshes of tetrahedra and of triangles share.
#pragma once

#include <algorithm>
#include <sstream>
#include <stdexcept>
#include <string>
#include <vector>

#include "tissue_contact/core/types.h"

namespace tissue_contact {

[[noreturn]] inline void refuseMesh(const std::string& source, const std::string& message) {
  throw std::invalid_argument(source + ": " + message);
}

inline std::string indexed(const std::string& thing, std::size_t index) { return thing + " " + std::to_string(index); }

inline void checkFiniteNodes(const NodalVectors& x, const std::string& source) {
  for (Eigen::Index i = 0; i < x.cols(); ++i) {
    if (x.col(i).allFinite()) continue;
    std::ostringstream message;
    message << "node " << i << " is at (" << x.col(i).transpose() << ") m; coordinates must be finite";
    refuseMesh(source, message.str());
  }
}

// Relative to the cube of the longest edge (a regular tetrahedron has 0.118): below it the sign of the volume is
// rounding.
constexpr double kZeroVolume = 1e-12;

/// Volume over the cube of the longest edge: free of the mesh's unit, and of overflow. NaN: all four nodes in one place.
inline double relativeVolume(const NodalVectors& x, const Tetrahedron& tet) {
  double longest = 0.0;
  for (std::size_t i = 0; i < tet.size(); ++i) {
    for (std::size_t j = 0; j < i; ++j) longest = std::max(longest, (x.col(tet[i]) - x.col(tet[j])).stableNorm());
  }
  const Vector3 b = (x.col(tet[1]) - x.col(tet[0])) / longest;
  const Vector3 c = (x.col(tet[2]) - x.col(tet[0])) / longest;
  const Vector3 d = (x.col(tet[3]) - x.col(tet[0])) / longest;
  return b.cross(c).dot(d) / 6.0;
}

/// No allocation while all is well.
inline void requireCount(const char* what, std::size_t given, std::size_t expected) {
  if (given == expected) return;
  refuseMesh(what, std::to_string(given) + " given; there must be " + std::to_string(expected));
}

/// @param thing "tetrahedron" or "triangle"
template <std::size_t N>
void checkNodeIndices(const std::array<int, N>& element, std::size_t index, Eigen::Index nodes, const char* thing,
                      const std::string& source) {
  for (const int node : element) {
    if (node >= 0 && node < nodes) continue;
    refuseMesh(source, indexed(thing, index) + " refers to node " + std::to_string(node) + ", but there are " +
                           std::to_string(nodes) + " nodes (numbered from 0)");
  }
}

template <std::size_t N>
void checkDuplicates(const std::vector<std::array<int, N>>& elements, const char* thing, const std::string& source) {
  std::vector<std::pair<std::array<int, N>, std::size_t>> sorted;
  sorted.reserve(elements.size());
  for (std::size_t i = 0; i < elements.size(); ++i) {
    std::array<int, N> key = elements[i];
    std::sort(key.begin(), key.end());
    sorted.emplace_back(key, i);
  }
  std::sort(sorted.begin(), sorted.end());
  const auto same =
      std::adjacent_find(sorted.begin(), sorted.end(), [](const auto& a, const auto& b) { return a.first == b.first; });
  if (same == sorted.end()) return;
  refuseMesh(source, indexed(thing, (same + 1)->second) +
                         (N == 4 ? " has the same four nodes as " : " has the same three nodes as ") +
                         indexed(thing, same->second) + "; remove one of the two");
}

/// @param fix what the user can do about it
template <std::size_t N>
void checkReferences(const std::vector<std::array<int, N>>& elements, Eigen::Index nodes, const char* thing,
                     const char* fix, const std::string& source) {
  std::vector<bool> used(static_cast<std::size_t>(nodes), false);
  for (const auto& element : elements) {
    for (const int node : element) used[static_cast<std::size_t>(node)] = true;
  }
  const auto unused = std::count(used.begin(), used.end(), false);
  if (unused == 0) return;
  const auto first = std::find(used.begin(), used.end(), false) - used.begin();
  refuseMesh(source, "node " + std::to_string(first) + " belongs to no " + thing + " (" + std::to_string(unused) +
                         " such in all); " + fix);
}

}  // namespace tissue_contact
