#include "tissue/neo_hookean_kernel.h"

#include <Eigen/LU>
#include <cmath>

#include "tissue/patch_kernel.h"

namespace tissue_contact {
namespace {

/// C = dJ/dF: its columns are the cross products of F's.
template <typename L>
TISSUE_CONTACT_INLINE void cofactors(const LaneMatrixOf<L>& F, LaneMatrixOf<L>& C) {
  for (std::size_t c = 0; c < 3; ++c) {
    const L* const a = F.m + 3 * ((c + 1) % 3);
    const L* const b = F.m + 3 * ((c + 2) % 3);
    C.m[3 * c] = a[1] * b[2] - a[2] * b[1];
    C.m[3 * c + 1] = a[2] * b[0] - a[0] * b[2];
    C.m[3 * c + 2] = a[0] * b[1] - a[1] * b[0];
  }
}

template <typename L>
TISSUE_CONTACT_INLINE unsigned changedLanes(const LaneMatrixOf<L>& F, const MatrixBatch* tangents, double change) {
  L squared = {};
  for (std::size_t k = 0; k < 9; ++k) {
    L t;
    loadEach(t, [=](std::size_t i) { return &tangents[i][k]; });
    squared += (F.m[k] - t) * (F.m[k] - t);
  }
  return bitsWhere<L>(squared > change * change);
}

template <typename L>
TISSUE_CONTACT_INLINE void keep(const LaneMatrixOf<L>& F, MatrixBatch* deformations) {
  for (std::size_t k = 0; k < 9; ++k) storeEach(F.m[k], [=](std::size_t i) { return &deformations[i][k]; });
}

/// P = along_F F + along_C C, the terms of neo_hookean.h. @param pressure to along_C, beside those.
template <typename L, typename Value>
TISSUE_CONTACT_INLINE void stress(const Value& lambda, const Value& mu, const LaneMatrixOf<L>& F,
                                  const LaneMatrixOf<L>& C, const L& J, const L& pressure, LaneMatrixOf<L>& P) {
  L I = F.m[0] * F.m[0];
  for (std::size_t i = 1; i < 9; ++i) I += F.m[i] * F.m[i];
  const L along_F = mu - mu / (I + 1.0);
  const L along_C = lambda * (J - 1.0) - 0.75 * mu + pressure;
  for (std::size_t i = 0; i < 9; ++i) P.m[i] = along_F * F.m[i] + along_C * C.m[i];
}

template <typename L>
TISSUE_CONTACT_INLINE void determinant(const LaneMatrixOf<L>& F, const LaneMatrixOf<L>& C, L& J) {
  J = F.m[0] * C.m[0] + F.m[1] * C.m[1] + F.m[2] * C.m[2];
}

template <typename Material>
TISSUE_CONTACT_INLINE void neoHookean(const std::vector<ElementBatch>& batches, BatchRange range,
                                      const Material& material, double tangent_change, const PaddedVector* x,
                                      const std::vector<MatrixBatch>& tangents, std::vector<MatrixBatch>& deformations,
                                      std::vector<unsigned char>& changed, double flat_modulus,
                                      ElementValues* volume_ratios, PaddedVector* forces) {
  forBatches(range, [&](std::size_t b, auto width) TISSUE_CONTACT_ALWAYS_INLINE {
    using L = typename decltype(width)::Type;
    LaneMatrixOf<L> F, C, P;
    typename Material::template Value<L> lambda, mu;
    deformationGradients(&batches[b], x, F);
    cofactors(F, C);
    material.get(b, lambda, mu);
    L J, against_flat = {};
    determinant(F, C, J);
    if (flat_modulus > 0.0) {
      const L flat = J - kFlat;
      against_flat = flat_modulus * mu * (flat < 0.0 ? flat : L{});
    }
    if (volume_ratios != nullptr) {
      ElementValues* const ratios = &volume_ratios[b];
      storeEach(J, [=](std::size_t i) { return &ratios[i]; });
    }
    stress(lambda, mu, F, C, J, against_flat, P);
    addStressForces(&batches[b], P, forces);
    keep(F, &deformations[b]);
    storeBits<L>(changedLanes(F, &tangents[b], tangent_change), &changed[b]);
  });
}

}  // namespace

bool isLargeDeformation(const MatrixBatch& F, std::size_t lane) {
  constexpr double kLargeSquared = 30.0;  // 3 at rest
  double squared = 0.0;
  for (const ElementValues& entry : F) squared += entry[lane] * entry[lane];
  return squared > kLargeSquared;
}

double neoHookeanEnergy(const Matrix3& F, const LameParameters& material) {
  const double I = F.squaredNorm();
  const double J = F.determinant();
  // lambda/2 ((J - alpha)^2 - (1 - alpha)^2) = (J - 1) (lambda/2 (J - 1) - 3/4 mu)
  return 0.5 * material.mu * (I - 3.0 - std::log((I + 1.0) / 4.0)) +
         (J - 1.0) * (0.5 * material.lambda * (J - 1.0) - 0.75 * material.mu);
}

TISSUE_CONTACT_CLONES
void addNeoHookeanForces(const std::vector<ElementBatch>& batches, BatchRange range, const LameParameters& material,
                         double tangent_change, const PaddedVector* x, const std::vector<MatrixBatch>& tangents,
                         std::vector<MatrixBatch>& deformations, std::vector<unsigned char>& changed,
                         double flat_modulus, ElementValues* volume_ratios, PaddedVector* forces) {
  neoHookean(batches, range, UniformMaterial{material}, tangent_change, x, tangents, deformations, changed,
             flat_modulus, volume_ratios, forces);
}

TISSUE_CONTACT_CLONES
void addNeoHookeanForces(const std::vector<ElementBatch>& batches, BatchRange range,
                         const std::vector<BatchMaterial>& materials, double tangent_change, const PaddedVector* x,
                         const std::vector<MatrixBatch>& tangents, std::vector<MatrixBatch>& deformations,
                         std::vector<unsigned char>& changed, double flat_modulus, ElementValues* volume_ratios,
                         PaddedVector* forces) {
  neoHookean(batches, range, VaryingMaterial{materials}, tangent_change, x, tangents, deformations, changed,
             flat_modulus, volume_ratios, forces);
}

TISSUE_CONTACT_CLONES
void addNeoHookeanPatchForces(const PatchElements& patches, BatchRange range, double tangent_change,
                              const PaddedVector* x, const std::vector<MatrixBatch>& tangents,
                              std::vector<MatrixBatch>& deformations, std::vector<unsigned char>& changed,
                              PaddedVector* forces) {
  const VaryingMaterial material{patches.materials};
  forPatchBatches(patches, range, [&](std::size_t b, auto width) TISSUE_CONTACT_ALWAYS_INLINE {
    using L = typename decltype(width)::Type;
    LaneMatrixOf<L> F, C, P;
    L lambda, mu, J;
    meanGradients(patches, b, x, F);
    cofactors(F, C);
    determinant(F, C, J);
    material.get(b, lambda, mu);
    stress(lambda, mu, F, C, J, L{}, P);
    keep(F, &deformations[b]);
    storeBits<L>(changedLanes(F, &tangents[b], tangent_change), &changed[b]);
    addPatchStressForces(patches, b, P, forces);
  });
}

TISSUE_CONTACT_CLONES
void addCofactorForces(const std::vector<ElementBatch>& batches, BatchRange range,
                       const std::vector<MatrixBatch>& deformations,
                       const std::vector<std::array<int, kLanes>>& group_of, const std::vector<double>& pressures,
                       PaddedVector* forces) {
  for (std::size_t b = range.begin; b < range.end; ++b) {
    LaneMatrix F, P;
    Lanes pressure;
    for (int lane = 0; lane < kLanes; ++lane) pressure[lane] = pressures[group_of[b][lane]];
    for (std::size_t i = 0; i < 9; ++i) load(deformations[b][i], F.m[i]);
    cofactors(F, P);
    for (Lanes& entry : P.m) entry *= pressure;
    addStressForces(&batches[b], P, forces);
  }
}

}  // namespace tissue_contact
