/// @file
/// Room `tissue`, private: rotations and elastic forces of four tetrahedra at a time, or eight, linear and corotational. Node
/// positions in; rotations, nodal forces and a mark for elements whose stiffness is out of date out. The formulas are
/// those of tet_elasticity.h, where nearestRotation() is the plain version this is tested against.
#pragma once

#include <array>
#include <vector>

#include "tissue/lanes.h"
#include "tissue_contact/core/types.h"

namespace tissue_contact {

struct PatchElements;

/// Quaternions (w, x, y, z) of four elements; need not be of unit length.
using RotationBatch = std::array<std::array<double, kLanes>, 4>;

/// A number for each of four elements.
using ElementValues = std::array<double, kLanes>;

/// For the batches of `range`: brings `rotations` up to date with positions x and adds the elastic forces to `forces`.
/// `turned[b]` gets bit `lane` set where the rotation is more than `tangent_angle` (rad, small) away from `tangents`.
/// The forces are those of `share` (0 to 1) of each rotation.
void addCorotationalForces(const std::vector<ElementBatch>& batches, BatchRange range, const LameParameters& material,
                           double tangent_angle, double share, const PaddedVector* x,
                           const std::vector<RotationBatch>& tangents, std::vector<RotationBatch>& rotations,
                           std::vector<unsigned char>& turned, PaddedVector* forces);
void addCorotationalForces(const std::vector<ElementBatch>& batches, BatchRange range,
                           const std::vector<BatchMaterial>& materials, double tangent_angle, double share,
                           const PaddedVector* x, const std::vector<RotationBatch>& tangents,
                           std::vector<RotationBatch>& rotations, std::vector<unsigned char>& turned,
                           PaddedVector* forces);

/// The same without rotations. `turn_squared`, unless null, is raised to the square of the largest turn, rad, where small.
void addLinearForces(const std::vector<ElementBatch>& batches, BatchRange range, const LameParameters& material,
                     const PaddedVector* x, PaddedVector* forces, double* turn_squared);
void addLinearForces(const std::vector<ElementBatch>& batches, BatchRange range,
                     const std::vector<BatchMaterial>& materials, const PaddedVector* x, PaddedVector* forces,
                     double* turn_squared);

/// The same of patches as elements, turning (`turns`) or linear: their strain is that of their mean F. All by batches of patches.
void addPatchForces(const PatchElements& patches, BatchRange range, bool turns, double tangent_angle,
                    const PaddedVector* x, const std::vector<RotationBatch>& tangents,
                    std::vector<RotationBatch>& rotations, std::vector<unsigned char>& turned, PaddedVector* forces);

/// Symmetric matrices of four elements: xx, yy, zz, xy, yz, zx.
using StrainBatch = std::array<ElementValues, 6>;

/// How a term of a Prony series goes on.
struct PronyStep {
  double decay = 1.0;  ///< of what it holds, over the time since the last update
  double gain = 1.0;   ///< of the strain that was added in that time
  double share = 0.0;  ///< of the shear modulus mu, times the decay over the step to come
};

/// Adds the forces of stress R 2 mu (sum of share h) R', h per term and element: brings rotations up to date as
/// addCorotationalForces() does (where `turns`; else R = I), takes the deviator d of R'F's strain and h <- decay h + gain
/// (d - last d). `held` keeps h, term after term for each batch; `strains` the last d.
void addOverstressForces(const std::vector<ElementBatch>& batches, const LameParameters& material, bool turns,
                         double tangent_angle, const PaddedVector* x, const std::vector<RotationBatch>& tangents,
                         std::vector<RotationBatch>& rotations, std::vector<unsigned char>& turned,
                         const std::vector<PronyStep>& steps, std::vector<StrainBatch>& strains,
                         std::vector<StrainBatch>& held, PaddedVector* forces);
void addOverstressForces(const std::vector<ElementBatch>& batches, const std::vector<BatchMaterial>& materials,
                         bool turns, double tangent_angle, const PaddedVector* x,
                         const std::vector<RotationBatch>& tangents, std::vector<RotationBatch>& rotations,
                         std::vector<unsigned char>& turned, const std::vector<PronyStep>& steps,
                         std::vector<StrainBatch>& strains, std::vector<StrainBatch>& held, PaddedVector* forces);

}  // namespace tissue_contact
