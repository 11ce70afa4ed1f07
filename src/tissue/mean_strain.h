/// @file
/// Room `tissue`, private: linear and corotational tetrahedra whose strain is averaged over patches of neighbours: the change of volume
/// all of it, so that they do not lock where Poisson's ratio is near 1/2, the change of shape in part, so that they bend more easily.
/// Positions in; elastic forces and the stiffness matrix out.
///
/// Per element e of a patch p, with F, rotation R and strain e of TetElasticity, and of the patch's own mean F,
///   Fbar = sum_e V F / V_p,   Rbar the rotation nearest to it,   ebar = sym(Rbar'Fbar) - I:
///   energy  sum_e V (1 - s) mu |dev e|^2  +  V_p (s mu_p |dev ebar|^2 + 1/2 kappa_p tr(ebar)^2),   kappa = lambda + 2/3 mu.
/// So a patch is one more element, of several nodes with the gradients sum_e V grad N / V_p, and is treated as such. Where F is the same
/// everywhere nothing is averaged, so that the limit of fine meshes stays. Couples all nodes of a patch: about twice the blocks of plain
/// tetrahedra.
/// Sources: mean dilatation, Nagtegaal, Parks & Rice, CMAME 4 (1974) 153-177; on patches of simplices, de Souza Neto, Andrade
/// Pires & Owen, IJNME 62 (2005) 353-383 (there for finite strains). Tetrahedra are too stiff, those of averaged strain too soft, and a
/// mixture is close to exact: Liu, Nguyen-Thoi & Lam, CMAME 197 (2008) 3883-3897 (there over the elements around each node).
#pragma once

#include <memory>
#include <vector>

#include "tissue/patch_elements.h"
#include "tissue_contact/tissue/tet_elasticity.h"

namespace tissue_contact {

/// s, also of neo-Hookean tissue. With 0.6 the five tetrahedra of a cell bend exactly (mean_strain_test). Less than that, since contact at vertices is somewhat
/// soft: doc/notes/method.md has what was measured.
constexpr double kPatchShapeShare = 0.45;

/// Model: const after construction. Thread-safe for different states.
class MeanStrain : public TetElasticity {
 public:
  /// @param patch_of per tetrahedron, from 0 without gaps.
  /// @param shape_share s, 0 to below 1: kPatchShapeShare, or 0 where changes of shape are not averaged.
  /// @throws std::invalid_argument for a material out of range or a patch_of of the wrong size.
  MeanStrain(const NodalVectors& rest, const std::vector<Tetrahedron>& tetrahedra, const std::vector<bool>& fixed,
             const ElementMaterials& materials, const std::vector<int>& patch_of, double shape_share);
  ~MeanStrain() override;

  std::unique_ptr<State> makeState() const override;
  std::unique_ptr<State> makeStateAt(const NodalVectors& x) const override;

  /// A patch's share of the stiffness, as an element's, is recomputed only when it has turned by more than kTangentAngle since.
  void update(const NodalVectors& x, State& state, NodalVectors& forces) const override;
  void holdStill(const std::vector<bool>& still, const NodalVectors& x, State& state) const override;
  double energy(const NodalVectors& x) const override;

 private:
  struct PatchState;

  MeanStrain(const NodalVectors& rest, const std::vector<Tetrahedron>& tetrahedra, const std::vector<bool>& fixed,
             const ElementMaterials& materials, const std::vector<int>& patch_of,
             std::vector<std::vector<int>> patch_nodes, double shape_share);
  std::unique_ptr<State> makeState(const NodalVectors* x) const;
  void addForces(const std::vector<BatchRange>& ranges, PatchState& state) const;

  bool corotational_;
  PatchElements patches_;
};

}  // namespace tissue_contact
