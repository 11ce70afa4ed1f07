/// @file
/// Room `tissue`, private: four tetrahedra at a time, or eight: how they are laid out, and the parts that force kernels share. These are
/// templates of L, Lanes or WideLanes; a function of two batches side by side takes pointers to the first.
#pragma once

#include <array>
#include <cstdint>
#include <cstring>
#include <vector>

#include "core/padded_vectors.h"
#include "tissue/shape_table.h"
#include "tissue_contact/core/types.h"
#include "tissue_contact/tissue/element_materials.h"

namespace tissue_contact {

/// Four elements side by side; the last batch of a mesh repeats its last element in the lanes beyond `used`.
struct ElementBatch {
  const ShapeBatch<9>* rest_inverse = nullptr;  ///< D_rest^-1, column-major, 1/m; that of all batches of this shape
  std::array<double, kLanes> volume;            ///< m^3; 0 in unused lanes
  std::array<Tetrahedron, kLanes> nodes;
};

/// Of all nodes, while kernels work on them.
struct KernelNodes {
  PaddedVectors x;       ///< m
  PaddedVectors forces;  ///< N

  /// @param held forces to begin with; without columns: none.
  void begin(const NodalVectors& positions, const NodalVectors& held) {
    pad(positions, x);
    if (held.cols() > 0) {
      pad(held, forces);
    } else {
      forces.assign(x.size(), PaddedVector{});
    }
  }
};

/// Batches [begin, end).
struct BatchRange {
  std::size_t begin = 0;
  std::size_t end = 0;
};

/// Elastic parameters of four elements, Pa: Lame's, or the model's own in their place.
struct BatchMaterial {
  std::array<double, kLanes> lambda;
  std::array<double, kLanes> mu;
};

using Mask = std::int64_t __attribute__((vector_size(kLanes * sizeof(std::int64_t))));

/// Column-major, as Eigen: element (r, c) is m[r + 3 c].
template <typename L>
struct LaneMatrixOf {
  L m[9];
};
using LaneMatrix = LaneMatrixOf<Lanes>;

TISSUE_CONTACT_INLINE void load(const std::array<double, kLanes>& from, Lanes& to) {
  std::memcpy(&to, from.data(), sizeof(Lanes));
}
TISSUE_CONTACT_INLINE void store(const Lanes& from, std::array<double, kLanes>& to) {
  std::memcpy(to.data(), &from, sizeof(Lanes));
}
TISSUE_CONTACT_INLINE bool any(const Mask& mask) { return (mask[0] | mask[1] | mask[2] | mask[3]) != 0; }

TISSUE_CONTACT_INLINE void powersOfTwo(Lanes& powers) { powers = Lanes{1.0, 2.0, 4.0, 8.0}; }
#ifdef TISSUE_CONTACT_WIDE
TISSUE_CONTACT_INLINE void powersOfTwo(WideLanes& powers) {
  powers = WideLanes{1.0, 2.0, 4.0, 8.0, 16.0, 32.0, 64.0, 128.0};
}
#endif

/// Bit `lane` set where the mask is.
TISSUE_CONTACT_INLINE unsigned char bits(const Mask& mask) {
  unsigned char set = 0;
  for (int lane = 0; lane < kLanes; ++lane) set |= static_cast<unsigned char>(mask[lane] != 0 ? 1u << lane : 0u);
  return set;
}

/// Bit `lane` set where `condition` holds. A sum of powers of two, since GCC 12 takes masks of eight lanes apart into scalars.
template <typename L, typename Condition>
TISSUE_CONTACT_INLINE unsigned bitsWhere(const Condition& condition) {
  L powers;
  powersOfTwo(powers);
  return static_cast<unsigned>(sum(condition ? powers : L{}));
}

/// `bits` of as many batches as L holds.
template <typename L>
TISSUE_CONTACT_INLINE void storeBits(unsigned bits, unsigned char* of_batches) {
  for (std::size_t i = 0; i < kFours<L>; ++i) of_batches[i] = static_cast<unsigned char>(bits >> (kLanes * i) & 15u);
}

/// @param of where each batch that L holds has its numbers: the first, of(0).
template <typename L, typename Of>
TISSUE_CONTACT_INLINE void loadEach(L& to, const Of& of) {
  Lanes fours[kFours<L>];
  for (std::size_t i = 0; i < kFours<L>; ++i) load(*of(i), fours[i]);
  join(fours, to);
}
template <typename L, typename Of>
TISSUE_CONTACT_INLINE void storeEach(const L& from, const Of& of) {
  Lanes fours[kFours<L>];
  split(from, fours);
  for (std::size_t i = 0; i < kFours<L>; ++i) store(fours[i], *of(i));
}

template <typename L>
struct Width {
  using Type = L;
};

#ifdef TISSUE_CONTACT_WIDE
template <typename Kernel>
TISSUE_CONTACT_WIDE void forPairs(BatchRange even, const Kernel& kernel) {
  for (std::size_t b = even.begin; b < even.end; b += 2) kernel(b, Width<WideLanes>());
}
#endif

/// Calls kernel(b, Width<L>) for the batches of `range`: two at a time as WideLanes where the processor has them.
template <typename Kernel>
TISSUE_CONTACT_INLINE void forBatches(BatchRange range, const Kernel& kernel) {
#ifdef TISSUE_CONTACT_WIDE
  if (hasWideLanes()) {
    const BatchRange even = {range.begin, range.end - (range.end - range.begin) % 2};
    forPairs(even, kernel);
    range.begin = even.end;
  }
#endif
  for (std::size_t b = range.begin; b < range.end; ++b) kernel(b, Width<Lanes>());
}

/// Node `corner` of each of the four elements.
TISSUE_CONTACT_INLINE std::array<int, kLanes> cornerOf(const ElementBatch& batch, std::size_t corner) {
  return {batch.nodes[0][corner], batch.nodes[1][corner], batch.nodes[2][corner], batch.nodes[3][corner]};
}

/// x, y and z of that node, of each batch that L holds.
template <typename L>
TISSUE_CONTACT_INLINE void gatherCorners(const ElementBatch* batches, std::size_t corner, const PaddedVector* x,
                                         L* to) {
  std::array<std::array<int, kLanes>, kFours<L>> nodes;
  std::array<const int*, kFours<L>> places;
  for (std::size_t i = 0; i < kFours<L>; ++i) {
    nodes[i] = cornerOf(batches[i], corner);
    places[i] = nodes[i].data();
  }
  gatherEach(x, places, to);
}

/// F = D D_rest^-1.
template <typename L>
TISSUE_CONTACT_INLINE void deformationGradients(const ElementBatch* batches, const PaddedVector* x,
                                                LaneMatrixOf<L>& F) {
  L origin[3], D[9];
  gatherCorners(batches, 0, x, origin);
  for (std::size_t c = 0; c < 3; ++c) {
    gatherCorners(batches, c + 1, x, &D[3 * c]);
    for (std::size_t r = 0; r < 3; ++r) D[r + 3 * c] -= origin[r];
  }
  for (std::size_t c = 0; c < 3; ++c) {
    L a, b, d;
    loadEach(a, [=](std::size_t i) { return &(*batches[i].rest_inverse)[3 * c]; });
    loadEach(b, [=](std::size_t i) { return &(*batches[i].rest_inverse)[3 * c + 1]; });
    loadEach(d, [=](std::size_t i) { return &(*batches[i].rest_inverse)[3 * c + 2]; });
    for (std::size_t r = 0; r < 3; ++r) F.m[r + 3 * c] = D[r] * a + D[r + 3] * b + D[r + 6] * d;
  }
}

/// The kernels are written once for both: one material in registers, or one to load per batch.
struct UniformMaterial {
  LameParameters material;
  TISSUE_CONTACT_INLINE void get(std::size_t, double& lambda, double& mu) const {
    lambda = material.lambda;
    mu = material.mu;
  }
  template <typename L>
  using Value = double;
};
struct VaryingMaterial {
  const std::vector<BatchMaterial>& materials;
  template <typename L>
  TISSUE_CONTACT_INLINE void get(std::size_t batch, L& lambda, L& mu) const {
    const BatchMaterial* const first = &materials[batch];
    loadEach(lambda, [=](std::size_t i) { return &first[i].lambda; });
    loadEach(mu, [=](std::size_t i) { return &first[i].mu; });
  }
  template <typename L>
  using Value = L;
};

/// Forces -V P grad N of first Piola-Kirchhoff stress P, added to the nodes.
template <typename L>
TISSUE_CONTACT_INLINE void addStressForces(const ElementBatch* batches, const LaneMatrixOf<L>& P,
                                           PaddedVector* forces) {
  L volume;
  loadEach(volume, [=](std::size_t i) { return &batches[i].volume; });
  L H[12];
  for (std::size_t node = 0; node < 3; ++node) {
    L g0, g1, g2;  // grad N of node + 1: row of D_rest^-1
    loadEach(g0, [=](std::size_t i) { return &(*batches[i].rest_inverse)[node]; });
    loadEach(g1, [=](std::size_t i) { return &(*batches[i].rest_inverse)[node + 3]; });
    loadEach(g2, [=](std::size_t i) { return &(*batches[i].rest_inverse)[node + 6]; });
    for (std::size_t r = 0; r < 3; ++r) {
      H[r + 3 * node] = -volume * (P.m[r] * g0 + P.m[r + 3] * g1 + P.m[r + 6] * g2);
    }
  }
  for (std::size_t r = 0; r < 3; ++r) H[9 + r] = -(H[r] + H[r + 3] + H[r + 6]);
  Lanes added[4][kLanes][kFours<L>];
  for (std::size_t node = 0; node < 4; ++node) {
    L of_lane[kLanes];
    transpose(H[3 * node], H[3 * node + 1], H[3 * node + 2], H[3 * node + 2], of_lane);
    for (std::size_t lane = 0; lane < kLanes; ++lane) split(of_lane[lane], added[node][lane]);
  }
  // Batch after batch, so that sums of a node have the same order for any L.
  for (std::size_t i = 0; i < kFours<L>; ++i) {
    for (std::size_t node = 0; node < 4; ++node) {
      const Lanes of_batch[kLanes] = {added[node][0][i], added[node][1][i], added[node][2][i], added[node][3][i]};
      addTo(cornerOf(batches[i], (node + 1) % 4).data(), of_batch, forces);
    }
  }
}

}  // namespace tissue_contact
