/// @file
/// Room `tissue`, private: rotations and elastic forces of four tetrahedra at a time, linear and corotational. Node
/// positions in; rotations, nodal forces and a mark for elements whose stiffness is out of date out. The formulas are
/// those of tet_elasticity.h, where nearestRotation() is the plain version this is tested against.
#pragma once

#include <array>
#include <vector>

#include "lanes.h"
#include "tissue_contact/core/types.h"

namespace tissue_contact {

/// Quaternions (w, x, y, z) of four elements; need not be of unit length.
using RotationBatch = std::array<std::array<double, kLanes>, 4>;

/// Brings `rotations` up to date with positions x (3 x n) and adds the elastic forces to `forces` (3 x n).
/// `turned[b]` gets bit `lane` set where the rotation is more than `tangent_angle` (rad, small) away from `tangents`.
void addCorotationalForces(const std::vector<ElementBatch>& batches, const LameParameters& material,
                           double tangent_angle, const double* x, const std::vector<RotationBatch>& tangents,
                           std::vector<RotationBatch>& rotations, std::vector<unsigned char>& turned, double* forces);
void addCorotationalForces(const std::vector<ElementBatch>& batches, const std::vector<BatchMaterial>& materials,
                           double tangent_angle, const double* x, const std::vector<RotationBatch>& tangents,
                           std::vector<RotationBatch>& rotations, std::vector<unsigned char>& turned, double* forces);

/// The same without rotations.
void addLinearForces(const std::vector<ElementBatch>& batches, const LameParameters& material, const double* x,
                     double* forces);
void addLinearForces(const std::vector<ElementBatch>& batches, const std::vector<BatchMaterial>& materials,
                     const double* x, double* forces);

}  // namespace tissue_contact
