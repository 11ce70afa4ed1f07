/// @file
/// Room `tissue`, private: stable neo-Hookean elasticity on four-node tetrahedra, for large strain. Positions in; elastic forces
/// and a positive semidefinite stiffness out.
///
/// Per element, with F as in tet_elasticity.h, I = F : F and J = det F, the energy per volume is
///   psi = mu/2 (I - 3) - mu/2 log((I + 1)/4) + lambda/2 (J - alpha)^2 - lambda/2 (1 - alpha)^2,
///   alpha = 1 + 3 mu / (4 lambda),
/// and the first Piola-Kirchhoff stress
///   P = mu (1 - 1/(I + 1)) F + (lambda (J - 1) - 3/4 mu) dJ/dF.
/// It is finite and smooth for every F, flat and inverted ones included, and an inverted element comes back. So that
/// small strains follow Young's modulus and Poisson's ratio exactly, mu = 4/3 mu_Lame and
/// lambda = lambda_Lame + 5/6 mu_Lame.
///
/// Stiffness: the exact second derivative without negative eigenvalues, element by element: down to -mu they are zero, beyond that what they
/// are more negative by counts as stiffness (doc/method.md: with zero alone tissue that is torn goes astray); in closed form
/// from the singular values of F (one 3 x 3 eigenproblem is left).
/// With a patch_of, a share s of psi is that of patches of neighbours as elements of several nodes, with the mean F of their
/// tetrahedra (patch_elements.h), as in mean_strain.h and for its reasons:
///   sum_e V ((1 - s) psi(F) + 8 mu min(0, J - 0.3)^2)  +  sum_p V_p s psi_p(Fbar),   psi_p of mean mu and lambda.
/// The second term, twice as stiff as a whole element at nu = .45, holds up what the patch would let go flat: without it single
/// elements turn inside out where a narrow tool sweeps deep, and hook it (doc/method.md). Under it nothing changes while J > 0.3.
///
/// Where the change of volume is averaged as well (scenes ask for it by `dilatation: patch`, since single elements lock where
/// Poisson's ratio is near 1/2), its energy beyond what elements need to keep their shape is that of each patch: psi has mu/8 for
/// lambda, and there is
///   sum_p V_p kappa/2 (Jbar - 1)^2,   Jbar = sum_e V J / V_p,
/// kappa = lambda - mu/8 = lambda_Lame + 2/3 mu_Lame: at small strain the elements' part is mu_Lame |dev e|^2, and the whole that
/// of mean_strain.h. The patch's pressure kappa (Jbar - 1) joins the factor of dJ/dF in each of its elements; with b = sum_e V dJ/dF grad N its own
/// stiffness is kappa/V_p b b'. Forces are the gradient of this energy, which F-bar (one J for all of a patch put into psi: de Souza
/// Neto, Andrade Pires & Owen, IJNME 62 (2005) 353-383) does not have without an unsymmetric stiffness; it is the mean dilatation of
/// Simo, Taylor & Pister, CMAME 51 (1985) 177-208, on patches.
/// Source: Smith, de Goes, Kim, "Stable Neo-Hookean Flesh Simulation", ACM TOG 37(2), 2018, eq. 14 and what follows.
#pragma once

#include <memory>
#include <vector>

#include "tissue/neo_hookean_kernel.h"
#include "tissue_contact/core/types.h"
#include "tissue_contact/tissue/elasticity.h"
#include "tissue_contact/tissue/element_materials.h"

namespace tissue_contact {

struct BatchRange;
struct DilatationPatches;
struct TetElements;
class NeoHookeanPatches;
class NeoHookeanStiffness;

/// Model: const after construction. Thread-safe for different states.
class NeoHookean : public Elasticity {
 public:
  /// What is averaged over patches.
  struct Averages {
    bool dilatation = false;  ///< the change of volume
    double share = 0.0;       ///< s, 0 to below 1
  };

  /// @param rest 3 x n, m.
  /// @param patch_of per tetrahedron, from 0 without gaps; empty: every element by itself.
  /// @throws std::invalid_argument for a material out of range or a patch_of of the wrong size.
  NeoHookean(const NodalVectors& rest, const std::vector<Tetrahedron>& tetrahedra, const std::vector<bool>& fixed,
             const ElementMaterials& materials)
      : NeoHookean(rest, tetrahedra, fixed, materials, {}, {}) {}
  NeoHookean(const NodalVectors& rest, const std::vector<Tetrahedron>& tetrahedra, const std::vector<bool>& fixed,
             const ElementMaterials& materials, const std::vector<int>& patch_of, const Averages& averages);
  ~NeoHookean() override;

  std::unique_ptr<State> makeState() const override;
  std::unique_ptr<State> makeStateAt(const NodalVectors& x) const override;

  /// An element's share of the stiffness is recomputed only when its F has changed by more than kTangentChange since, that of
  /// a patch when its mean F has, and that of its mean dilatation when the F of one of its elements or Jbar has;
  /// forces are always exact.
  void update(const NodalVectors& x, State& state, NodalVectors& forces) const override;

  void holdStill(const std::vector<bool>& still, const NodalVectors& x, State& state) const override;

  double energy(const NodalVectors& x) const override;

  /// Frobenius norm of the change of F: a turn of 0.4 degrees or a strain of 1 %. As for TetElasticity, this is below
  /// the first-order error of the implicit Euler step itself.
  static constexpr double kTangentChange = 0.01;

 private:
  struct DeformationState;

  std::unique_ptr<DeformationState> undeformed() const;  ///< without stiffness
  void evaluate(const std::vector<BatchRange>& ranges, DeformationState& state) const;
  void addPatches(const std::vector<BatchRange>& ranges, bool still, DeformationState& state) const;
  void addShare(std::size_t e, const std::vector<MatrixBatch>& F, double pressure, double sign,
                NeoHookeanStiffness& sum) const;
  void addPatchStiffness(std::size_t patch, double sign, DeformationState& state) const;
  void rebuildStiffness(DeformationState& state) const;
  void refreshStiffness(bool still, DeformationState& state) const;
  void refreshElements(const std::vector<BatchRange>& ranges, bool rebuilds, DeformationState& state,
                       NeoHookeanStiffness& sum) const;
  void markStalePatches(const std::vector<BatchRange>& ranges, bool still, DeformationState& state) const;
  bool rebuildsFor(const std::vector<BatchRange>& elements, const std::vector<BatchRange>& patches,
                   const DeformationState& state) const;
  void refreshPatches(bool rebuilds, DeformationState& state, NeoHookeanStiffness& sum) const;

  std::unique_ptr<const TetElements> tets_;
  std::unique_ptr<const NeoHookeanPatches> shares_;  ///< what patches resist as elements; null: nothing
  std::unique_ptr<const DilatationPatches>
      patches_;                ///< that average the change of volume; null: every element by itself
  double flat_modulus_ = 0.0;  ///< over an element's mu
};

}  // namespace tissue_contact
