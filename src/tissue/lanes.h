/// @file
/// Room `tissue`, private: four tetrahedra at a time: how they are laid out, and the parts that force kernels share.
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
struct LaneMatrix {
  Lanes m[9];
};
TISSUE_CONTACT_INLINE void load(const std::array<double, kLanes>& from, Lanes& to) {
  std::memcpy(&to, from.data(), sizeof(Lanes));
}
TISSUE_CONTACT_INLINE void store(const Lanes& from, std::array<double, kLanes>& to) {
  std::memcpy(to.data(), &from, sizeof(Lanes));
}
TISSUE_CONTACT_INLINE bool any(const Mask& mask) { return (mask[0] | mask[1] | mask[2] | mask[3]) != 0; }

/// Bit `lane` set where the mask is.
TISSUE_CONTACT_INLINE unsigned char bits(const Mask& mask) {
  unsigned char set = 0;
  for (int lane = 0; lane < kLanes; ++lane) set |= static_cast<unsigned char>(mask[lane] != 0 ? 1u << lane : 0u);
  return set;
}

/// Node `corner` of each of the four elements.
TISSUE_CONTACT_INLINE std::array<int, kLanes> cornerOf(const ElementBatch& batch, std::size_t corner) {
  return {batch.nodes[0][corner], batch.nodes[1][corner], batch.nodes[2][corner], batch.nodes[3][corner]};
}

/// F = D D_rest^-1.
TISSUE_CONTACT_INLINE void deformationGradients(const ElementBatch& batch, const PaddedVector* x, LaneMatrix& F) {
  Lanes origin[3], D[9];
  gather(x, cornerOf(batch, 0).data(), origin);
  for (std::size_t c = 0; c < 3; ++c) {
    gather(x, cornerOf(batch, c + 1).data(), &D[3 * c]);
    for (std::size_t r = 0; r < 3; ++r) D[r + 3 * c] -= origin[r];
  }
  const ShapeBatch<9>& rest_inverse = *batch.rest_inverse;
  for (std::size_t c = 0; c < 3; ++c) {
    Lanes a, b, d;
    load(rest_inverse[3 * c], a);
    load(rest_inverse[3 * c + 1], b);
    load(rest_inverse[3 * c + 2], d);
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
  using Value = double;
};
struct VaryingMaterial {
  const std::vector<BatchMaterial>& materials;
  TISSUE_CONTACT_INLINE void get(std::size_t batch, Lanes& lambda, Lanes& mu) const {
    load(materials[batch].lambda, lambda);
    load(materials[batch].mu, mu);
  }
  using Value = Lanes;
};

/// Forces -V P grad N of first Piola-Kirchhoff stress P, added to the nodes.
TISSUE_CONTACT_INLINE void addStressForces(const ElementBatch& batch, const LaneMatrix& P, PaddedVector* forces) {
  Lanes volume;
  load(batch.volume, volume);
  const ShapeBatch<9>& rest_inverse = *batch.rest_inverse;
  Lanes H[9];
  for (std::size_t node = 0; node < 3; ++node) {
    Lanes g0, g1, g2;  // grad N of node + 1: row of D_rest^-1
    load(rest_inverse[node], g0);
    load(rest_inverse[node + 3], g1);
    load(rest_inverse[node + 6], g2);
    for (std::size_t r = 0; r < 3; ++r) {
      H[r + 3 * node] = -volume * (P.m[r] * g0 + P.m[r + 3] * g1 + P.m[r + 6] * g2);
    }
  }
  for (std::size_t node = 0; node < 3; ++node) scatterAdd(&H[3 * node], cornerOf(batch, node + 1).data(), forces);
  const Lanes rest[3] = {-(H[0] + H[3] + H[6]), -(H[1] + H[4] + H[7]), -(H[2] + H[5] + H[8])};
  scatterAdd(rest, cornerOf(batch, 0).data(), forces);
}

}  // namespace tissue_contact
