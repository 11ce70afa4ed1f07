/// @file
/// Room `tissue`, private: linear and corotational tetrahedra whose change of volume is averaged over patches of neighbours, so that
/// they do not lock where Poisson's ratio is near 1/2. Positions in; elastic forces and the stiffness matrix out.
///
/// Per element e of a patch p, with the rotation R and strain e of TetElasticity and t = tr(R'F) - 3:
///   energy  sum_e V mu |dev e|^2  +  1/2 kappa_p V_p tbar^2,   tbar = sum_e V t / V_p,   kappa = lambda + 2/3 mu.
/// With b = sum_e V R grad N (per node of the patch) tbar = (b . x)/V_p - 3, so the volumetric force is -kappa_p tbar b and
/// its tangent kappa_p / V_p b b'. Couples all nodes of a patch: about twice the blocks of plain tetrahedra. The force is that
/// of a mean stress kappa_p tbar R in every element, which is how it is computed where elements turn.
/// Source: mean dilatation, Nagtegaal, Parks & Rice, CMAME 4 (1974) 153-177; on patches of simplices, de Souza Neto, Andrade
/// Pires & Owen, IJNME 62 (2005) 353-383 (there for finite strains).
#pragma once

#include <memory>
#include <vector>

#include "tissue/dilatation_patches.h"
#include "tissue_contact/tissue/tet_elasticity.h"

namespace tissue_contact {

/// Model: const after construction. Thread-safe for different states.
class MeanDilatation : public TetElasticity {
 public:
  /// @param patch_of per tetrahedron, from 0 without gaps.
  /// @throws std::invalid_argument for a material out of range or a patch_of of the wrong size.
  MeanDilatation(const NodalVectors& rest, const std::vector<Tetrahedron>& tetrahedra, const std::vector<bool>& fixed,
                 const ElementMaterials& materials, const std::vector<int>& patch_of);
  ~MeanDilatation() override;

  std::unique_ptr<State> makeState() const override;
  std::unique_ptr<State> makeStateAt(const NodalVectors& x) const override;
  void update(const NodalVectors& x, State& state, NodalVectors& forces) const override;
  void holdStill(const std::vector<bool>& still, const NodalVectors& x, State& state) const override;
  double energy(const NodalVectors& x) const override;

 private:
  using Patch = DilatationPatches::Patch;
  struct PatchState;

  MeanDilatation(const NodalVectors& rest, const std::vector<Tetrahedron>& tetrahedra, const std::vector<bool>& fixed,
                 const ElementMaterials& materials, const std::vector<int>& patch_of,
                 std::vector<std::vector<int>> patch_nodes);
  std::unique_ptr<State> makeState(const NodalVectors* x) const;
  void addGradients(const Patch& patch, const RotationState& state, Vector3* gradients) const;
  static double dilatation(const Patch& patch, const Vector3* gradients, const NodalVectors& x);
  void refreshStiffness(const std::vector<BatchRange>& ranges, PatchState& state) const;
  void addForces(const NodalVectors& x, const std::vector<BatchRange>& ranges, bool still, PatchState& state,
                 NodalVectors& forces) const;

  bool corotational_;
  DilatationPatches averaged_;
};

}  // namespace tissue_contact
