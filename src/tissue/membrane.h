/// @file
/// Room `tissue`, private: membranes, cloth and strips: constant-strain triangles in plane stress, with bending. Positions in;
/// elastic forces and a positive semidefinite stiffness out.
///
/// In-plane, per triangle of area A and thickness h, with F = [x1-x0, x2-x0] D_rest^-1 (3 x 2) = R U, R'R = I, U
/// symmetric:
///   strain e = U - I,  stress P = R (2 mu e + lambda tr(e) I) = R T,  energy A h (mu e:e + lambda/2 tr(e)^2),
/// mu and lambda of plane stress: a strip with nu = 0 pulled to any length l carries E h b (l/L - 1). U and R are in
/// closed form (2 x 2 polar decomposition), and remain defined for a triangle folded or collapsed flat.
/// The stiffness is the exact second derivative, the part that stress adds included where it is in tension (what makes
/// a taut membrane resist a push across it), without its negative part in compression.
/// Bending: src/tissue/plate_bending.h, with stiffness B per width from the material: that of a plate,
/// E h^3 / (12 (1 - nu^2)), unless it gives its own; 0: none, and then no cost.
///
/// @note A clamped edge takes two rows of fixed nodes, since one row holds positions only; the slope is then held half
/// way between the two. A fold of 180 degrees in a body that is curved at rest is as far as its bending can tell.
#pragma once

#include <memory>
#include <vector>

#include "tissue_contact/core/types.h"
#include "tissue_contact/tissue/elasticity.h"
#include "tissue_contact/tissue/element_materials.h"

namespace tissue_contact {

struct MembraneTriangle;
class PlateBending;

/// Model: const after construction. Thread-safe for different states.
class Membrane : public Elasticity {
 public:
  /// @param rest 3 x n, m.
  /// @param triangles as checkSheetMesh accepts them.
  /// @param thickness_m > 0.
  /// @throws std::invalid_argument for a thickness or material out of range.
  Membrane(const NodalVectors& rest, const std::vector<Triangle>& triangles, const std::vector<bool>& fixed,
           double thickness_m, const ElementMaterials& materials);
  ~Membrane() override;

  std::unique_ptr<State> makeState() const override;

  /// Forces and matrices are of the present positions.
  void update(const NodalVectors& x, State& state, NodalVectors& forces) const override;

  double energy(const NodalVectors& x) const override;

 private:
  struct MembraneState;

  std::vector<MembraneTriangle> triangles_;
  std::unique_ptr<const PlateBending> bending_;
  BlockMatrix constant_stiffness_;  ///< what of K never changes; also the pattern
  BlockMatrix constant_damping_;
  NodalVectors rest_;
};

}  // namespace tissue_contact
