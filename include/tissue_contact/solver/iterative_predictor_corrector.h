/// @file
/// Room `solver`: the iterative predictor-corrector for static and kinetic friction on top of iterative constraint
/// anticipation (ICA). A contact problem and a warm start in; velocities, impulses, states and residuals out.
///
/// One iteration:
///  1. Relax: one block Gauss-Seidel sweep on A v = b + J'lambda with lambda held (ICA's splitting A = P - N with
///     P the block diagonal; Otaduy, Tamstorf, Steinemann & Gross 2009, section 5). Sweep direction alternates.
///  2. Anticipate, predict, correct: contact by contact on the local operator W = J P^-1 J'. The velocity the contact
///     would have without its own impulse predicts the sliding direction; if the impulse that stops the sliding is
///     inside the limit the contact is static, else kinetic at mu_k along it. v += P^-1 J' (change of lambda) at once.
/// At a fixed point both steps change nothing, so A v = b + J'lambda and every contact law hold together.
///
/// Reconstructed choices (the source text stops before its method section):
///  - the corrector solves the one-contact problem exactly (solveCoulombContact) instead of taking one predictor step;
///  - hysteresis works from step to step; within a step a contact that keeps changing between static and kinetic is
///    held to the kinetic limit (kMaxFlips), which ends cycles between two answers that are both consistent;
///  - static contacts are bilateral rows of W.
/// "Predictor-corrector" here has nothing to do with Incremental Potential Contact.
#pragma once

#include <vector>

#include "tissue_contact/solver/contact_problem.h"
#include "tissue_contact/solver/residuals.h"

namespace tissue_contact {

struct SolverOptions {
  int iterations = 30;      ///< upper bound, >= 1
  int contact_passes = 2;   ///< passes over the contacts per iteration, >= 1
  double tolerance = 3e-4;  ///< relative change of momentum and impulses in one iteration at which to stop
};

struct SolverReport {
  int iterations = 0;
  bool converged = false;  ///< stopped by the tolerance, not by the iteration bound
  Residuals residuals;     ///< after the last sweep
};

/// Holds the workspace: one object per thread. Deterministic. solve() allocates only when a problem is larger than
/// before.
class IterativePredictorCorrector {
 public:
  explicit IterativePredictorCorrector(const SolverOptions& options);

  /// @param solution in: warm start (sizes must match the problem); out: the answer. Fixed nodes keep v = 0.
  SolverReport solve(const ContactProblem& problem, ContactSolution& solution);

 private:
  /// What a contact needs in the inner loop, gathered once per step.
  struct Prepared {
    Matrix3 W;                            ///< J P^-1 J', contact frame, 1/kg
    std::array<Matrix3, 3> response;      ///< weights[a] * P_a^-1 * R_WC: change of node velocity per impulse
    std::array<Matrix3, 3> distribution;  ///< weights[a] * R_WC for free nodes, 0 for fixed ones
    int flips = 0;                        ///< changes between static and kinetic in this step
    bool usable = false;                  ///< some node of it can move
  };

  void prepareBodies(const ContactProblem& problem);
  void prepareContacts(const ContactProblem& problem, ContactSolution& solution);
  double sweep(const ContactProblem& problem, bool forward, std::vector<NodalVectors>& v) const;
  double contactPass(const ContactProblem& problem, ContactSolution& solution);
  bool small(double momentum_change, double impulse_change, const ContactSolution& solution) const;

  static constexpr int kMaxFlips = 4;

  SolverOptions options_;
  std::vector<std::vector<Matrix3>> block_inverse_;  ///< P_i^-1 per body and node; 0 for fixed nodes
  std::vector<NodalVectors> contact_impulses_;       ///< J'lambda per body
  std::vector<NodalVectors> scratch_;
  std::vector<Prepared> prepared_;
  double load_scale_ = 0.0;  ///< |b|, N s
};

}  // namespace tissue_contact
