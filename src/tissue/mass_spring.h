/// @file
/// Room `tissue`, private: mass-spring volumes: a linear spring along every edge of a tetrahedral mesh. Positions in; spring
/// forces and a positive semidefinite stiffness out.
///
/// A spring of rest length L and stiffness k at length l along n pulls with k (l - L). Its stiffness block is
/// k (n n' + max(0, 1 - L/l) (I - n n')): exact in tension, without the negative geometric part in compression.
///
/// Stiffness of springs: k = sum over the tetrahedra of an edge of  w E V / L^2. With w = 1 (van Gelder, "Approximate
/// simulation of elastic membranes by triangulated spring meshes", JGT 1998, in its volume form) springs that point
/// evenly in all directions make an isotropic body of Young's modulus E. A mesh's edges do not: the factor
/// w = 1 + s : (n n n n), one symmetric tensor s for the whole mesh, is what makes its springs together, under uniform
/// strain, isotropic with modulus E (as far as 0.4 <= w <= 10 allows: spring_stiffness.h); the energy of a uniform dilation is right in any
/// case. Compare Lloyd, Szekely, Harders, "Identification of spring parameters for deformable object simulation",
/// TVCG 2007, who fit regular meshes.
///
/// @warning Poisson's ratio is that of central forces, 1/4, whatever the material says. Springs do not mind being
/// turned inside out: an element that inverts may stay so. Use a finite-element model where either matters.
#pragma once

#include <memory>
#include <vector>

#include "tissue_contact/core/types.h"
#include "tissue_contact/tissue/elasticity.h"
#include "tissue_contact/tissue/element_materials.h"

namespace tissue_contact {

struct Spring;

/// Model: const after construction. Thread-safe for different states.
class MassSpring : public Elasticity {
 public:
  /// @param rest 3 x n, m.
  /// @throws std::invalid_argument for a material out of range.
  MassSpring(const NodalVectors& rest, const std::vector<Tetrahedron>& tetrahedra, const std::vector<bool>& fixed,
             const ElementMaterials& materials);
  ~MassSpring() override;

  std::unique_ptr<State> makeState() const override;

  /// Forces and matrices are of the present positions.
  void update(const NodalVectors& x, State& state, NodalVectors& forces) const override;

  /// sum k/2 (l - L)^2.
  double energy(const NodalVectors& x) const override;

 private:
  std::vector<Spring> springs_;
  std::shared_ptr<const BlockPattern> pattern_;
  bool damps_;
  NodalVectors rest_;
};

}  // namespace tissue_contact
