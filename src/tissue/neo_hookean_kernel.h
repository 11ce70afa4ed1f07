/// @file
/// Room `tissue`, private: neo-Hookean forces of four tetrahedra at a time, or eight. Node positions in; deformation gradients,
/// nodal forces and a mark for elements whose stiffness is out of date out. The formulas are those of neo_hookean.h.
#pragma once

#include <array>
#include <vector>

#include "tissue/element_kernel.h"

namespace tissue_contact {

/// Column-major 3 x 3 matrices of four elements.
using MatrixBatch = std::array<std::array<double, kLanes>, 9>;

/// Elements of patches resist by kFlatModulus mu (J - kFlat) dJ/dF where J is below kFlat.
constexpr double kFlat = 0.3;
constexpr double kFlatModulus = 16.0;

/// Whether F is so large that taking its share out of the stiffness again, which grows as |F|^4, would leave round-off behind that
/// others notice.
bool isLargeDeformation(const MatrixBatch& F, std::size_t lane);

/// psi of neo_hookean.h, J/m^3. @param material lambda and mu of the model.
double neoHookeanEnergy(const Matrix3& F, const LameParameters& material);

/// Computes `deformations` F at positions x and adds the elastic forces to `forces`. `changed[b]` gets
/// bit `lane` set where F is further than `tangent_change` (Frobenius norm) away from `tangents`. `volume_ratios`, unless null,
/// gets J = det F of every element, by batch.
/// @param material lambda and mu of the model, which are not Lame's. @param flat_modulus over mu; 0: no patches.
void addNeoHookeanForces(const std::vector<ElementBatch>& batches, BatchRange range, const LameParameters& material,
                         double tangent_change, const PaddedVector* x, const std::vector<MatrixBatch>& tangents,
                         std::vector<MatrixBatch>& deformations, std::vector<unsigned char>& changed,
                         double flat_modulus, ElementValues* volume_ratios, PaddedVector* forces);
void addNeoHookeanForces(const std::vector<ElementBatch>& batches, BatchRange range,
                         const std::vector<BatchMaterial>& materials, double tangent_change, const PaddedVector* x,
                         const std::vector<MatrixBatch>& tangents, std::vector<MatrixBatch>& deformations,
                         std::vector<unsigned char>& changed, double flat_modulus, ElementValues* volume_ratios,
                         PaddedVector* forces);

/// The same of patches as elements: their stress is that of their mean F. All by batches of patches.
void addNeoHookeanPatchForces(const PatchElements& patches, BatchRange range, double tangent_change,
                              const PaddedVector* x, const std::vector<MatrixBatch>& tangents,
                              std::vector<MatrixBatch>& deformations, std::vector<unsigned char>& changed,
                              PaddedVector* forces);

/// Adds the forces of stresses p dJ/dF: -V p dJ/dF grad N. `group_of` names for each element of a batch its place in
/// `pressures`, Pa.
void addCofactorForces(const std::vector<ElementBatch>& batches, BatchRange range,
                       const std::vector<MatrixBatch>& deformations,
                       const std::vector<std::array<int, kLanes>>& group_of, const std::vector<double>& pressures,
                       PaddedVector* forces);

}  // namespace tissue_contact
