/// @file
/// Room `tissue`, private: rotations and elastic forces of four tetrahedra at a time. Node positions in; rotations,
/// nodal forces and a mark for elements whose stiffness is out of date out. The formulas are those of elasticity.h.
///
/// Every lane does the same IEEE operations in the same order whatever the processor's vector width, so the bits do not
/// depend on the machine. nearestRotation() is the plain version it is tested against.
#pragma once

#include <array>
#include <vector>

#include "tissue_contact/core/types.h"

namespace tissue_contact {

constexpr int kLanes = 4;

/// Four elements side by side; the last batch of a mesh repeats its last element in the lanes beyond `used`.
struct ElementBatch {
  std::array<std::array<double, kLanes>, 9> rest_inverse;  ///< D_rest^-1, column-major, 1/m
  std::array<double, kLanes> volume;                       ///< m^3; 0 in unused lanes
  std::array<Tetrahedron, kLanes> nodes;
};

/// Quaternions (w, x, y, z) of four elements; need not be of unit length.
using RotationBatch = std::array<std::array<double, kLanes>, 4>;

struct KernelMaterial {
  double lame_lambda;  ///< Pa
  double lame_mu;      ///< Pa
};

/// Brings `rotations` up to date with positions x (3 x n) and adds the elastic forces to `forces` (3 x n).
/// `turned[b]` gets bit `lane` set where the rotation is more than `tangent_angle` (rad, small) away from `tangents`.
void addCorotationalForces(const std::vector<ElementBatch>& batches, const KernelMaterial& material,
                           double tangent_angle, const double* x, const std::vector<RotationBatch>& tangents,
                           std::vector<RotationBatch>& rotations, std::vector<unsigned char>& turned, double* forces);

/// The same without rotations.
void addLinearForces(const std::vector<ElementBatch>& batches, const KernelMaterial& material, const double* x,
                     double* forces);

}  // namespace tissue_contact
