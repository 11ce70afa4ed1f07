/// @file
/// Room `tissue`, private: stress relaxation beside an elastic model of tetrahedra. Positions and times in; forces and the
/// stiffness of both together out.
///
/// Beside the relaxed body stand Maxwell elements that resist changes of shape. With R and e = sym(R'F) - I of each tetrahedron
/// as in tet_elasticity.h (R = I beside the linear model) and mu Lame's parameter of the relaxed material,
///   stress  P = P_relaxed + R sum_k 2 mu g_k h_k,     dh_k/dt + h_k / tau_k = d(dev e)/dt,
/// which a step takes exactly for a strain that changes at a constant rate:
///   h_k <- exp(-dt/tau_k) h_k + (1 - exp(-dt/tau_k)) tau_k/dt (change of dev e).
/// While the strain is held, G(t) = mu (1 + sum_k g_k exp(-t/tau_k)). An implicit step from x to x + dt v takes
/// exp(-dt/tau_k) h_k(x) as the force, and as the stiffness that of the terms at once, mu g_k, whatever dt. What h_k keeps of
/// the step's strain is less, (1 - exp(-s))/s of it with s = dt/tau_k: for s small the step takes s/2 too much, an error of
/// first order like that of implicit Euler itself, and on the stable side; for s large s times too much, so that a term much
/// faster than the step brakes as a damping of mu g_k dt would in place of its own viscosity mu g_k tau_k.
/// Source: Simo & Hughes, "Computational Inelasticity" (1998), section 10.3 and its recurrence; as an overstress on a relaxed
/// body as in Govindjee & Reese 1997, here linear in the strain seen from the turned element.
#pragma once

#include <memory>
#include <vector>

#include "tissue_contact/tissue/tet_elasticity.h"

namespace tissue_contact {

/// The Maxwell elements alone. Model: const after construction. Thread-safe for different states.
class Overstress : private TetElasticity {
 public:
  /// @param materials with a Prony series; the terms of the first are those of all.
  /// @param pattern holds at least the blocks of the tetrahedra.
  Overstress(const NodalVectors& rest, const std::vector<Tetrahedron>& tetrahedra, const std::vector<bool>& fixed,
             const ElementMaterials& materials, std::shared_ptr<const BlockPattern> pattern);
  ~Overstress() override;

  std::unique_ptr<State> makeState() const override;
  /// One that remembers what `before` does: strains, whatever their moduli.
  std::unique_ptr<State> makeStateAfter(const State& before, const NodalVectors& x) const override;
  /// Adds the forces (N) at positions x (m) and brings the matrices up to date. No allocation.
  void addForces(const NodalVectors& x, Elasticity::State& state, NodalVectors& forces) const;
  using TetElasticity::energy;  ///< if x were taken at once

 private:
  struct MaxwellState;
  std::vector<PronyTerm> terms_;
  double ratios_;  ///< sum over the terms
  bool turns_;
};

/// A relaxed body and the Maxwell elements beside it.
class Viscoelastic : public Elasticity {
 public:
  /// @param relaxed of the same tetrahedra. The other arguments are those of Overstress.
  Viscoelastic(std::unique_ptr<const Elasticity> relaxed, const NodalVectors& rest,
               const std::vector<Tetrahedron>& tetrahedra, const std::vector<bool>& fixed,
               const ElementMaterials& materials);

  std::unique_ptr<State> makeState() const override;
  std::unique_ptr<State> makeStateAfter(const State& before, const NodalVectors& x) const override;
  void update(const NodalVectors& x, State& state, NodalVectors& forces) const override;
  bool hasMemory() const override { return true; }
  /// If x were taken at once: the most there can be.
  double energy(const NodalVectors& x) const override { return relaxed_->energy(x) + overstress_.energy(x); }

 private:
  struct SumState;
  static std::unique_ptr<State> sumOf(std::unique_ptr<State> relaxed, std::unique_ptr<State> overstress);

  std::unique_ptr<const Elasticity> relaxed_;
  Overstress overstress_;
};

}  // namespace tissue_contact
