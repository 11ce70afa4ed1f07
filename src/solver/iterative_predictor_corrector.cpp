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

/// Of all contacts together, N s.
double impulseNorm(const std::vector<Vector3>& impulses) {
  double sum = 0.0;
  for (const Vector3& impulse : impulses) sum += impulse.squaredNorm();
  return std::sqrt(sum);
}

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

/// At most contact_passes passes over the contacts, fewer once one changes the impulses by no more than the tolerance.
/// @return |change of the impulses| of the first pass, N s.
double IterativePredictorCorrector::correctContacts(const ContactProblem& problem, ContactSolution& solution) {
  relaxation_->beginPasses(solution);
  const double first = relaxation_->contactPass(problem, corrector_, solution);
  double last = first;
  for (int pass = 1; pass < options_.contact_passes && last > options_.tolerance * impulseNorm(solution.impulses);
       ++pass) {
    last = relaxation_->contactPass(problem, corrector_, solution);
  }
  return first;
}

bool IterativePredictorCorrector::converged(double momentum_change, double impulse_change,
                                            const ContactSolution& solution) const {
  const double impulses = impulseNorm(solution.impulses);
  return momentum_change <= options_.tolerance * (load_scale_ + impulses) &&
         impulse_change <= options_.tolerance * impulses;
}

SolverReport IterativePredictorCorrector::solve(const ContactProblem& problem, ContactSolution& solution) {
  // With neither budget nor deadline the clock has no say.
  const double hard_s =
      options_.time_budget_s > 0.0 ? std::min(deadline_s_, clock_() + options_.time_budget_s) : deadline_s_;
  load_scale_ = loadScale(problem);
  relaxation_->prepare(problem, solution);
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
    if (converged(momentum_change, impulse_change, solution)) {
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
