/// @file
/// Room `solver`, private: what the predictor-corrector's loop needs from a splitting A = P - N: relaxing the velocities
/// with impulses held, and passes over the contacts on the local operator W_P = J P^-1 J'.
#pragma once

#include <memory>
#include <vector>

#include "solver/contact_corrector.h"
#include "tissue_contact/solver/contact_problem.h"

namespace tissue_contact {

/// What is missing from A v = b + J'lambda, nodes that contacts hold aside.
struct MomentumDefect {
  double norm_n_s = 0.0;        ///< root of the squares over all nodes, N s
  std::vector<double> net_n_s;  ///< per body: what all its nodes lack together, N s; 0 where no contact acts on it
};

class Relaxation {
 public:
  virtual ~Relaxation() = default;

  /// Begins a step. Contacts on nodes that cannot move lose their impulse.
  virtual void prepare(const ContactProblem& problem, ContactSolution& solution) = 0;

  /// Relaxes v with the impulses held (MICA's projections aside).
  /// @return what was met on the way; valid until the next one.
  virtual const MomentumDefect& relax(const ContactProblem& problem, int iteration, ContactCorrector& corrector,
                                      ContactSolution& solution) = 0;

  /// Called after an iteration. @param iterations that are likely to come.
  virtual void foresee(double /*iterations*/) {}

  /// Called before the passes of an iteration, with v relaxed.
  virtual void beginPasses(const ContactSolution& /*solution*/) {}

  /// Corrects every contact once.
  virtual void contactPass(const ContactProblem& problem, ContactCorrector& corrector, ContactSolution& solution) = 0;

  /// Ends a step: brings v in line with the impulses.
  virtual void finish(const ContactProblem& /*problem*/, ContactSolution& /*solution*/) {}

  /// Whether passes can go on after finish() to see what contacts lack, since they meet the velocities that impulses really bring; begins them
  /// then. Neither they nor this change the answers of later steps, nor v.
  virtual bool resumePasses(const ContactProblem& /*problem*/, const ContactSolution& /*solution*/) { return false; }

  virtual void reset() {}
};

/// P = block diagonal of A; one sweep per relaxation, alternating direction. From the seventh iteration of a step on,
/// each pair of sweeps starts from Anderson's mixture of the velocities that the pairs before led to.
std::unique_ptr<Relaxation> makeGaussSeidelRelaxation();

/// P = A of an earlier step, factored.
std::unique_ptr<Relaxation> makeCholeskyRelaxation();

}  // namespace tissue_contact
