/// @file
/// Room `solver`, private: the iterative predictor-corrector for static and kinetic friction on top of iterative
/// constraint anticipation (ICA). A contact problem and a warm start in; velocities, impulses, states and residuals out.
///
/// One iteration:
///  1. Relax A v = b + J'lambda with lambda held (Relaxation: block Gauss-Seidel sweep or lagged Cholesky factor), by the
///     splitting A = P - N (Otaduy, Tamstorf, Steinemann & Gross 2009, section 5).
///  2. Anticipate, predict, correct: contact by contact on the local operator W_P = J P^-1 J'. The velocity the contact
///     would have without its own impulse predicts the sliding direction; if the impulse that stops the sliding is
///     inside the limit the contact is static, else kinetic at mu_k along it. v += P^-1 J' (change of lambda) at once.
/// The sweeps of hard steps are accelerated by Anderson's mixing (makeGaussSeidelRelaxation).
/// At a fixed point both steps change nothing, so A v = b + J'lambda and every contact law hold together.
///
/// MICA: a static contact is a linear projection constraint of the same loop. A node held by a contact of its own is
/// projected onto the tool's velocity as the sweep visits it; a barycentric contact is a bilateral row of W_P. Both are
/// released as soon as the reaction leaves the static limit or stops pushing.
///
/// Reconstructed choices (the source text stops before its method section):
///  - the corrector solves the one-contact problem exactly (solveCoulombContact) instead of taking one predictor step;
///  - hysteresis works from step to step; within a step a contact that keeps changing between static and kinetic is
///    held to the kinetic limit (ContactCorrector), which ends cycles between two consistent solutions;
///  - contacts that were static are held at the static limit until all else is solved (ContactCorrector::hold), and what they carry begins
///    with its instrument's motion (predictRigidMotions()).
/// "Predictor-corrector" here has nothing to do with Incremental Potential Contact.
#pragma once

#include <limits>
#include <memory>
#include <vector>

#include "solver/contact_momentum.h"
#include "solver/convergence_forecast.h"
#include "solver/relaxation.h"
#include "tissue_contact/solver/contact_solver.h"
#include "tissue_contact/solver/solver_options.h"

namespace tissue_contact {

class IterativePredictorCorrector : public ContactSolver {
 public:
  /// @param clock needed for a time budget or deadline only.
  /// @param rival solves the single contacts instead (room baselines).
  /// @throws std::invalid_argument as requireSolverOptions.
  explicit IterativePredictorCorrector(const SolverOptions& options, SecondsClock clock = nullptr,
                                       ContactRival rival = nullptr);

  /// Allocates only when a problem is larger than before or a factor is renewed.
  SolverReport solve(const ContactProblem& problem, ContactSolution& solution) override;
  double impulseLacking(const ContactProblem& problem, const ContactSolution& solution) override;
  void setDeadline(double clock_s, double prompt_s) override;
  void reset() override { relaxation_->reset(); }

 private:
  bool correctContacts(const ContactProblem& problem, ContactSolution& solution);
  double pass(const ContactProblem& problem, ContactSolution& solution);
  bool settled(const ContactProblem& problem, const ContactSolution& solution, double change, double before,
               double share);
  bool balanced(const ContactProblem& problem, const MomentumDefect& met, const ContactSolution& solution);
  struct Allowed {
    double norm_n_s;
    double net_n_s;
  };
  Allowed allowedDefect(const ContactSolution& solution) const;
  double excess(const MomentumDefect& met, const ContactSolution& solution) const;
  bool looseBodiesBalanced(const ContactProblem& problem, const std::vector<double>& net_n_s,
                           const ContactSolution& solution);

  SolverOptions options_;
  SecondsClock clock_;
  std::unique_ptr<Relaxation> relaxation_;
  ContactCorrector corrector_;
  ContactMomentum momentum_;
  ConvergenceForecast forecast_;
  ContactSolution further_;      ///< scratch of impulseLacking()
  std::vector<Vector3> before_;  ///< impulses before the last pass, per contact, contact frame, N s
  /// What contacts bring a body.
  struct Brought {
    Vector3 net_n_s;
    double sum_n_s;  ///< of the magnitudes
  };
  std::vector<Brought> brought_;  ///< scratch: per body
  double first_change_ = 0.0;     ///< of impulses by the first pass of the last iteration, N s; infinity: none yet
  double deadline_s_ = std::numeric_limits<double>::infinity();  ///< on clock_
  double prompt_s_ = std::numeric_limits<double>::infinity();    ///< on clock_
  double load_scale_ = 0.0;                                      ///< what changes velocities, N s
};

}  // namespace tissue_contact
