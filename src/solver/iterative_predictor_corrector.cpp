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

/// Of the tolerance: passes go on until one brings less. Where contacts are nearly dependent several times as much is still to come.
constexpr double kPassShare = 0.3;

/// Impulses that fall less than to this share of their change before only pass from one of dependent contacts to the next.
constexpr double kFalls = 0.9;

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

IterativePredictorCorrector::ContactChange IterativePredictorCorrector::pass(const ContactProblem& problem,
                                                                             ContactSolution& solution) {
  before_.resize(solution.impulses.size());  // unlike an assignment, grows by more than it must
  std::copy(solution.impulses.begin(), solution.impulses.end(), before_.begin());
  relaxation_->contactPass(problem, corrector_, solution);
  double squared = 0.0;
  for (std::size_t c = 0; c < before_.size(); ++c) squared += (solution.impulses[c] - before_[c]).squaredNorm();
  return {momentum_.change(problem, before_, solution.impulses), std::sqrt(squared)};
}

/// Whether what contacts bring to nodes changes by no more than `little` of their impulses, and they themselves by no more than
/// the tolerance or without falling any more. While they fall they still tell what sticks and what slides.
bool IterativePredictorCorrector::settled(const ContactChange& change, const ContactChange& before, double little,
                                          const ContactSolution& solution) const {
  const double impulses = impulseNorm(solution.impulses);
  return change.momentum <= little * impulses &&
         (change.impulses <= options_.tolerance * impulses || change.impulses > kFalls * before.impulses);
}

/// At most contact_passes passes over the contacts, fewer once they settle.
/// @return what the first one changed.
IterativePredictorCorrector::ContactChange IterativePredictorCorrector::correctContacts(const ContactProblem& problem,
                                                                                        ContactSolution& solution) {
  relaxation_->beginPasses(solution);
  const ContactChange first = pass(problem, solution);
  ContactChange before = kUnknown;
  ContactChange last = first;
  for (int passes = 1;
       passes < options_.contact_passes && !settled(last, before, kPassShare * options_.tolerance, solution);
       ++passes) {
    before = last;
    last = pass(problem, solution);
  }
  return first;
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
  ContactChange before = kUnknown;
  for (bool stop = false; !stop;) {
    const double momentum_change = relaxation_->relax(problem, report.iterations, corrector_, solution);
    const ContactChange change = correctContacts(problem, solution);
    const bool is_solved = momentum_change <= options_.tolerance * (load_scale_ + impulseNorm(solution.impulses)) &&
                           settled(change, before, options_.tolerance, solution);
    before = change;
    ++report.iterations;
    const double until = report.iterations >= kLeastBeforePrompt ? std::min(hard_s, prompt_s_) : hard_s;
    stop = true;
    if (is_solved) {
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
