#include "tissue/neo_hookean_kernel.h"

#include <Eigen/LU>
#include <cmath>

#include "tissue/patch_kernel.h"

namespace tissue_contact {
namespace {

/// C = dJ/dF: its columns are the cross products of F's.
TISSUE_CONTACT_INLINE void cofactors(const LaneMatrix& F, LaneMatrix& C) {
  for (std::size_t c = 0; c < 3; ++c) {
    const Lanes* const a = F.m + 3 * ((c + 1) % 3);
    const Lanes* const b = F.m + 3 * ((c + 2) % 3);
    C.m[3 * c] = a[1] * b[2] - a[2] * b[1];
    C.m[3 * c + 1] = a[2] * b[0] - a[0] * b[2];
    C.m[3 * c + 2] = a[0] * b[1] - a[1] * b[0];
  }
}

TISSUE_CONTACT_INLINE unsigned char changedLanes(const LaneMatrix& F, const MatrixBatch& tangent, double change) {
  Lanes squared = {0.0, 0.0, 0.0, 0.0};
  for (std::size_t i = 0; i < 9; ++i) {
    Lanes t;
    load(tangent[i], t);
    squared += (F.m[i] - t) * (F.m[i] - t);
  }
  return bits(squared > change * change);
}

/// P = along_F F + along_C C, the terms of neo_hookean.h. @param pressure to along_C, beside those.
template <typename Value>
TISSUE_CONTACT_INLINE void stress(const Value& lambda, const Value& mu, const LaneMatrix& F, const LaneMatrix& C,
                                  const Lanes& J, const Lanes& pressure, LaneMatrix& P) {
  Lanes I = F.m[0] * F.m[0];
  for (std::size_t i = 1; i < 9; ++i) I += F.m[i] * F.m[i];
  const Lanes along_F = mu - mu / (I + 1.0);
  const Lanes along_C = lambda * (J - 1.0) - 0.75 * mu + pressure;
  for (std::size_t i = 0; i < 9; ++i) P.m[i] = along_F * F.m[i] + along_C * C.m[i];
}

TISSUE_CONTACT_INLINE void determinant(const LaneMatrix& F, const LaneMatrix& C, Lanes& J) {
  J = F.m[0] * C.m[0] + F.m[1] * C.m[1] + F.m[2] * C.m[2];
}

template <typename Material>
TISSUE_CONTACT_INLINE void neoHookean(const std::vector<ElementBatch>& batches, BatchRange range,
                                      const Material& material, double tangent_change, const PaddedVector* x,
                                      const std::vector<MatrixBatch>& tangents, std::vector<MatrixBatch>& deformations,
                                      std::vector<unsigned char>& changed, double flat_modulus,
                                      ElementValues* volume_ratios, PaddedVector* forces) {
  for (std::size_t b = range.begin; b < range.end; ++b) {
    LaneMatrix F, C, P;
    typename Material::Value lambda, mu;
    deformationGradients(batches[b], x, F);
    cofactors(F, C);
    material.get(b, lambda, mu);
    Lanes J, against_flat = {};
    determinant(F, C, J);
    if (flat_modulus > 0.0) {
      const Lanes flat = J - kFlat;
      against_flat = flat_modulus * mu * (flat < 0.0 ? flat : Lanes{});
    }
    if (volume_ratios != nullptr) store(J, volume_ratios[b]);
    stress(lambda, mu, F, C, J, against_flat, P);
    addStressForces(batches[b], P, forces);
    for (std::size_t i = 0; i < 9; ++i) store(F.m[i], deformations[b][i]);
    changed[b] = changedLanes(F, tangents[b], tangent_change);
  }
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
  for (std::size_t b = range.begin; b < range.end; ++b) {
    const PatchBatch& batch = patches.batches[b];
    const PatchNode* const nodes = &patches.nodes[batch.first];
    LaneMatrix F, C, P;
    Lanes lambda, mu, J;
    meanGradients(nodes, batch.count, x, F);
    cofactors(F, C);
    determinant(F, C, J);
    material.get(b, lambda, mu);
    stress(lambda, mu, F, C, J, Lanes{}, P);
    for (std::size_t i = 0; i < 9; ++i) store(F.m[i], deformations[b][i]);
    changed[b] = changedLanes(F, tangents[b], tangent_change);
    addPatchStressForces(batch, nodes, P, forces);
  }
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
    addStressForces(batches[b], P, forces);
  }
}

}  // namespace tissue_contact
