#include "solver/iterative_predictor_corrector.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>

#include "tissue_contact/solver/residuals.h"

namespace tissue_contact {
namespace {

/// Before it is cut short by the prompt deadline. Where every step of press and drag (605 nodes, 1 ms) ends after ten,
/// the force errs by 0.05 % (RMS against the converged one), and nine steps of ten are done by then.
constexpr int kLeastBeforePrompt = 10;

/// Of the tolerance: passes go on until one changes less. Where contacts are nearly dependent several times as much is still to come.
constexpr double kPassShare = 0.3;

}  // namespace

IterativePredictorCorrector::IterativePredictorCorrector(const SolverOptions& options, SecondsClock clock,
                                                         ContactRival rival)
    : options_(options),
      clock_(std::move(clock)),
      relaxation_(options.relaxation == RelaxationKind::kCholesky ? makeCholeskyRelaxation()
                                                                  : makeGaussSeidelRelaxation()),
      corrector_(std::move(rival)) {
  requireSolverOptions(options, clock_);
}

void IterativePredictorCorrector::setDeadline(double clock_s, double prompt_s) {
  if (std::isnan(clock_s) || std::isnan(prompt_s)) throw std::invalid_argument("the solver's deadline is not a number");
  if (!clock_ && std::isfinite(std::min(clock_s, prompt_s))) {
    throw std::invalid_argument("the solver has a deadline, but there is no clock here; give the simulator a clock");
  }
  deadline_s_ = clock_s;
  prompt_s_ = prompt_s;
}

/// At most contact_passes passes over the contacts, fewer once one changes the momentum they bring by little.
/// @return |change of that momentum| of the first pass, N s.
double IterativePredictorCorrector::correctContacts(const ContactProblem& problem, ContactSolution& solution) {
  relaxation_->beginPasses(solution);
  double first = 0.0;
  double little = 0.0;
  for (int pass = 0; pass < options_.contact_passes; ++pass) {
    before_ = solution.impulses;
    relaxation_->contactPass(problem, corrector_, solution);
    const double change = momentum_.change(problem, solution.impulses, before_);
    if (pass == 0) {
      first = change;
      little = kPassShare * options_.tolerance * momentum_.norm(problem, solution.impulses);
    }
    if (!(change > little)) break;
  }
  return first;
}

bool IterativePredictorCorrector::converged(const ContactProblem& problem, double momentum_change,
                                            double impulse_change, const ContactSolution& solution) {
  const double impulses = momentum_.norm(problem, solution.impulses);
  return momentum_change <= options_.tolerance * (load_scale_ + impulses) &&
         impulse_change <= options_.tolerance * impulses;
}

SolverReport IterativePredictorCorrector::solve(const ContactProblem& problem, ContactSolution& solution) {
  // With neither budget nor deadline the clock has no say.
  const double hard_s =
      options_.time_budget_s > 0.0 ? std::min(deadline_s_, clock_() + options_.time_budget_s) : deadline_s_;
  load_scale_ = loadScale(problem);
  relaxation_->prepare(problem, solution);
  momentum_.prepare(problem);
  corrector_.prepare(problem.contacts.size(), [&](std::size_t c) -> Vector2 {
    return relativeVelocity(problem.contacts[c], solution.v).tail<2>();
  });
  SolverReport report;
  for (bool stop = false; !stop;) {
    const double momentum_change = relaxation_->relax(problem, report.iterations, corrector_, solution);
    const double impulse_change = correctContacts(problem, solution);
    ++report.iterations;
    const double until = report.iterations >= kLeastBeforePrompt ? std::min(hard_s, prompt_s_) : hard_s;
    stop = true;
    if (converged(problem, momentum_change, impulse_change, solution)) {
      report.stop = StopReason::kTolerance;
    } else if (report.iterations >= options_.iterations) {
      report.stop = StopReason::kIterations;
    } else if (std::isfinite(until) && clock_() >= until) {
      report.stop = StopReason::kTimeBudget;
    } else {
      stop = false;
    }
  }
  relaxation_->finish(problem, solution);
  return report;
}

}  // namespace tissue_contact
