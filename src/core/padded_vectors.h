/// @file
/// Room `core`, private: a vector per node as loops in lanes read and write it, padded to four numbers: four nodes' vectors
/// are four loads and a transposition, and adding to one is one addition. Three numbers each would be twelve loads, put
/// together one by one, and two additions. Costs a copy in and out.
#pragma once

#include <array>
#include <cstddef>
#include <cstring>
#include <vector>

#include "core/lanes.h"
#include "tissue_contact/core/types.h"

namespace tissue_contact {

struct alignas(32) PaddedVector {
  std::array<double, kLanes> at;  ///< x, y, z, anything
};
using PaddedVectors = std::vector<PaddedVector>;

inline Eigen::Map<Vector3> vectorOf(PaddedVector& vector) { return Eigen::Map<Vector3>(vector.at.data()); }
inline Eigen::Map<const Vector3> vectorOf(const PaddedVector& vector) {
  return Eigen::Map<const Vector3>(vector.at.data());
}

/// Allocates only for another number of nodes than before.
inline void pad(const NodalVectors& from, PaddedVectors& to) {
  to.resize(static_cast<std::size_t>(from.cols()));
  const double* next = from.data();
  for (PaddedVector& vector : to) {
    vector.at = {next[0], next[1], next[2], 0.0};
    next += 3;
  }
}

/// @param to of as many nodes.
inline void unpad(const PaddedVectors& from, NodalVectors& to) {
  double* next = to.data();
  for (const PaddedVector& vector : from) {
    std::memcpy(next, vector.at.data(), 3 * sizeof(double));
    next += 3;
  }
}

TISSUE_CONTACT_INLINE void load(const PaddedVector& from, Lanes& to) { std::memcpy(&to, &from, sizeof(Lanes)); }

/// to[r] is place r of a, b, c and d. What nobody uses of it costs nothing.
TISSUE_CONTACT_INLINE void transpose(const Lanes& a, const Lanes& b, const Lanes& c, const Lanes& d, Lanes* to) {
  const Lanes even_ab = TISSUE_CONTACT_SHUFFLE(a, b, 0, 4, 2, 6);
  const Lanes even_cd = TISSUE_CONTACT_SHUFFLE(c, d, 0, 4, 2, 6);
  const Lanes odd_ab = TISSUE_CONTACT_SHUFFLE(a, b, 1, 5, 3, 7);
  const Lanes odd_cd = TISSUE_CONTACT_SHUFFLE(c, d, 1, 5, 3, 7);
  to[0] = TISSUE_CONTACT_SHUFFLE(even_ab, even_cd, 0, 1, 4, 5);
  to[1] = TISSUE_CONTACT_SHUFFLE(odd_ab, odd_cd, 0, 1, 4, 5);
  to[2] = TISSUE_CONTACT_SHUFFLE(even_ab, even_cd, 2, 3, 6, 7);
  to[3] = TISSUE_CONTACT_SHUFFLE(odd_ab, odd_cd, 2, 3, 6, 7);
}

#ifdef TISSUE_CONTACT_WIDE
TISSUE_CONTACT_INLINE void transpose(const WideLanes& a, const WideLanes& b, const WideLanes& c, const WideLanes& d,
                                     WideLanes* to) {
  const WideLanes even_ab = __builtin_shufflevector(a, b, 0, 8, 2, 10, 4, 12, 6, 14);
  const WideLanes even_cd = __builtin_shufflevector(c, d, 0, 8, 2, 10, 4, 12, 6, 14);
  const WideLanes odd_ab = __builtin_shufflevector(a, b, 1, 9, 3, 11, 5, 13, 7, 15);
  const WideLanes odd_cd = __builtin_shufflevector(c, d, 1, 9, 3, 11, 5, 13, 7, 15);
  to[0] = __builtin_shufflevector(even_ab, even_cd, 0, 1, 8, 9, 4, 5, 12, 13);
  to[1] = __builtin_shufflevector(odd_ab, odd_cd, 0, 1, 8, 9, 4, 5, 12, 13);
  to[2] = __builtin_shufflevector(even_ab, even_cd, 2, 3, 10, 11, 6, 7, 14, 15);
  to[3] = __builtin_shufflevector(odd_ab, odd_cd, 2, 3, 10, 11, 6, 7, 14, 15);
}
#endif

/// x, y and z of four nodes, of each four that L holds.
template <typename L>
TISSUE_CONTACT_INLINE void gatherEach(const PaddedVector* v, const std::array<const int*, kFours<L>>& nodes, L* to) {
  L of_lane[kLanes], all[kLanes];
  for (std::size_t lane = 0; lane < kLanes; ++lane) {
    Lanes fours[kFours<L>];
    for (std::size_t i = 0; i < kFours<L>; ++i) load(v[nodes[i][lane]], fours[i]);
    join(fours, of_lane[lane]);
  }
  transpose(of_lane[0], of_lane[1], of_lane[2], of_lane[3], all);
  for (int r = 0; r < 3; ++r) to[r] = all[r];
}

TISSUE_CONTACT_INLINE void gather(const PaddedVector* v, const int* nodes, Lanes* to) {
  gatherEach<Lanes>(v, {nodes}, to);
}

/// Adds to four nodes, one after the other, for two may be the same.
/// @param added what transpose() makes of their x, y and z.
TISSUE_CONTACT_INLINE void addTo(const int* nodes, const Lanes* added, PaddedVector* v) {
  for (int lane = 0; lane < kLanes; ++lane) {
    Lanes sum;
    load(v[nodes[lane]], sum);
    sum += added[lane];
    std::memcpy(&v[nodes[lane]], &sum, sizeof(Lanes));
  }
}

TISSUE_CONTACT_INLINE void scatterAdd(const Lanes* from, const int* nodes, PaddedVector* v) {
  Lanes added[kLanes];
  transpose(from[0], from[1], from[2], from[2], added);
  addTo(nodes, added, v);
}

/// The last one first: where a node is there twice, its first vector stays.
TISSUE_CONTACT_INLINE void scatter(const Lanes* from, const int* nodes, PaddedVector* v) {
  Lanes vectors[kLanes];
  transpose(from[0], from[1], from[2], from[2], vectors);
  for (int lane = kLanes; lane-- > 0;) std::memcpy(&v[nodes[lane]], &vectors[lane], sizeof(Lanes));
}

}  // namespace tissue_contact
