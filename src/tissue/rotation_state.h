/// @file
/// Room `tissue`, private: what TetElasticity, and models that add to it, keep of each element.
#pragma once

#include <vector>

#include "tissue/element_kernel.h"
#include "tissue/tet_elements.h"
#include "tissue_contact/tissue/tet_elasticity.h"

namespace tissue_contact {

inline Quaternion rotationInLane(const RotationBatch& q, std::size_t lane) {
  return Quaternion(q[0][lane], q[1][lane], q[2][lane], q[3][lane]).normalized();
}

/// Rotations are kept four elements at a time, as (w, x, y, z) of any length.
struct TetElasticity::RotationState : State {
  std::vector<RotationBatch> rotations;          ///< of each element at the last update
  std::vector<RotationBatch> tangent_rotations;  ///< those `stiffness` was computed with
  std::vector<unsigned char> turned;             ///< scratch: elements to refresh, a bit each
  TetElements::Held held;
  KernelNodes nodes;          ///< scratch
  int blend = kBlendUpdates;  ///< of kBlendUpdates parts: how much of each rotation counts
  int blend_to = kBlendUpdates;
  int updates = 0;            ///< since rotations were last measured
  int calm = 0;               ///< updates for which no element has been turned far
  double turn_squared = 0.0;  ///< largest at the last update, while linear; rad^2

  void carry(StateArchive& archive) override {
    State::carry(archive);
    archive.carry(rotations);
    archive.carry(tangent_rotations);
    held.carry(archive, rotations.size(), stiffness.rows());
    for (int* const count : {&blend, &blend_to, &updates, &calm}) archive.carry(*count);
    archive.carry(turn_squared);
  }
};

}  // namespace tissue_contact
