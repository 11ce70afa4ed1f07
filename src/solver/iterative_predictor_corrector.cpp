#include "solver/iterative_predictor_corrector.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <map>
#include <numeric>
#include <stdexcept>
#include <utility>

#include "solver/residual_measures.h"
#include "solver/rigid_prediction.h"

namespace tissue_contact {
namespace {

/// Before it is cut short by the prompt deadline. Where every step of press and drag (605 nodes, 1 ms) ends after ten,
/// the force errs by 0.05 % (RMS against the converged one), and nine steps of ten are done by then.
constexpr int kLeastBeforePrompt = 10;

/// Of the tolerance: passes go on until one brings less. Where contacts are nearly dependent several times as much is still to come.
constexpr double kPassShare = 0.3;

/// Impulses that fall less than to this share of their change before only pass from one of dependent contacts to the next.
constexpr double kFalls = 0.9;

/// Of the tolerance: what all nodes of a body may lack together, over the sum of impulses. Defects of many nodes that point the same way
/// hold the whole body back while their squares say little: a liver under a probe erred by eleven to sixteen times its tolerance (doc/notes/method.md).
constexpr double kNetShare = 2.0;

/// Of the impulses on a body that nothing holds: what moves it in all counts as no less, or one that is pressed from opposed sides and
/// weighs nothing would have to be solved to the last digit.
constexpr double kLooseShare = 0.05;

/// Of all contacts together, N s.
double impulseNorm(const std::vector<Vector3>& impulses) {
  double sum = 0.0;
  for (const Vector3& impulse : impulses) sum += impulse.squaredNorm();
  return std::sqrt(sum);
}

/// Of the magnitudes, N s.
double impulseSum(const std::vector<Vector3>& impulses) {
  double sum = 0.0;
  for (const Vector3& impulse : impulses) sum += impulse.norm();
  return sum;
}

/// Of all bodies, N s.
double netOf(const MomentumDefect& met) { return std::accumulate(met.net_n_s.begin(), met.net_n_s.end(), 0.0); }

/// Of what changes velocities in the step and of all nodes at a nanometre per second, N s. A part of b itself would be a part of the momentum:
/// with a tolerance of 0.01 falling bodies lost up to nine tenths of their weight, and a flap gained energy as it swung.
double changeScale(const ContactProblem& problem) {
  double change = 0.0;
  double mass = 0.0;
  for (const BodySystem& body : problem.bodies) {
    if (body.asleep) continue;
    change += body.change_n_s < 0.0 ? body.b.squaredNorm() : body.change_n_s * body.change_n_s;
    mass += body.mass.squaredNorm();
  }
  return std::sqrt(change) + kStillSpeed * std::sqrt(mass);
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

/// @return |change of the impulses|, N s.
double IterativePredictorCorrector::pass(const ContactProblem& problem, ContactSolution& solution) {
  before_.resize(solution.impulses.size());  // unlike an assignment, grows by more than it must
  std::copy(solution.impulses.begin(), solution.impulses.end(), before_.begin());
  relaxation_->contactPass(problem, corrector_, solution);
  double squared = 0.0;
  for (std::size_t c = 0; c < before_.size(); ++c) squared += (solution.impulses[c] - before_[c]).squaredNorm();
  return std::sqrt(squared);
}

/// Whether impulses change by no more than the tolerance or without falling any more, and what they bring to nodes by no more
/// than `share` of it. While they fall they still tell what sticks and what slides.
/// @param change of the impulses by the last pass. @param before the same of the one to compare it with, N s.
bool IterativePredictorCorrector::settled(const ContactProblem& problem, const ContactSolution& solution, double change,
                                          double before, double share) {
  const double little = options_.tolerance * impulseNorm(solution.impulses);
  return (change <= little || change > kFalls * before) &&
         momentum_.change(problem, before_, solution.impulses) <= share * little;
}

/// Whether what momentum lacks is within the tolerance: node by node, and all together, also while a contact is only near,
/// since the next touch is with what a body did before it.
bool IterativePredictorCorrector::balanced(const ContactProblem& problem, const MomentumDefect& met,
                                           const ContactSolution& solution) {
  const Allowed allowed = allowedDefect(solution);
  return met.norm_n_s <= allowed.norm_n_s && netOf(met) <= allowed.net_n_s &&
         looseBodiesBalanced(problem, met.net_n_s, solution);
}

/// What momentum may lack, node by node and all together.
IterativePredictorCorrector::Allowed IterativePredictorCorrector::allowedDefect(const ContactSolution& solution) const {
  return {options_.tolerance * (load_scale_ + impulseNorm(solution.impulses)),
          kNetShare * options_.tolerance * (load_scale_ + impulseSum(solution.impulses))};
}

/// What momentum lacks over what it may lack. What more bodies must meet that nothing holds has no say here.
double IterativePredictorCorrector::excess(const MomentumDefect& met, const ContactSolution& solution) const {
  const Allowed allowed = allowedDefect(solution);
  return std::max(met.norm_n_s / allowed.norm_n_s, netOf(met) / allowed.net_n_s);
}

/// Likewise of each body that nothing holds, against what moves it in all: the jaws' squeeze, which cancels, may be a hundred times that.
bool IterativePredictorCorrector::looseBodiesBalanced(const ContactProblem& problem, const std::vector<double>& net_n_s,
                                                      const ContactSolution& solution) {
  const auto is_loose = [](const BodySystem& body) { return body.net_change_n_s >= 0.0 && !body.asleep; };
  if (std::none_of(problem.bodies.begin(), problem.bodies.end(), is_loose)) return true;
  brought_.assign(problem.bodies.size(), {Vector3::Zero(), 0.0});
  for (std::size_t c = 0; c < problem.contacts.size(); ++c) {
    const ContactRow& row = problem.contacts[c];
    const Vector3 impulse_W = row.R_WC * solution.impulses[c];
    for (int a = 0; a < row.node_count; ++a) {
      const Vector3 share = row.nodes[a].weight * impulse_W;
      brought_[row.nodes[a].body].net_n_s += share;
      brought_[row.nodes[a].body].sum_n_s += share.norm();
    }
  }
  for (std::size_t k = 0; k < problem.bodies.size(); ++k) {
    if (!is_loose(problem.bodies[k]) || brought_[k].sum_n_s == 0.0) continue;
    const double moves = problem.bodies[k].net_change_n_s + brought_[k].net_n_s.norm();
    const double scale = std::max(moves, kLooseShare * brought_[k].sum_n_s);
    if (net_n_s[k] > kNetShare * options_.tolerance * scale) return false;
  }
  return true;
}

/// At most contact_passes passes over the contacts, fewer once they settle.
/// @return they had settled before: the first one changed little.
bool IterativePredictorCorrector::correctContacts(const ContactProblem& problem, ContactSolution& solution) {
  relaxation_->beginPasses(solution);
  double change = pass(problem, solution);
  const bool had_settled = settled(problem, solution, change, first_change_, 1.0);
  first_change_ = change;
  double before = std::numeric_limits<double>::infinity();
  for (int passes = 1; passes < options_.contact_passes && !settled(problem, solution, change, before, kPassShare);
       ++passes) {
    before = change;
    change = pass(problem, solution);
  }
  return had_settled;
}

/// Passes go on from the answer, until they bring little or for so many.
double IterativePredictorCorrector::impulseLacking(const ContactProblem& problem, const ContactSolution& solution) {
  constexpr int kMostPasses = 20;
  if (problem.contacts.empty() || solution.states.size() != problem.contacts.size()) return 0.0;
  if (!relaxation_->resumePasses(problem, solution)) return 0.0;
  further_ = solution;
  double change = pass(problem, further_);
  double before = std::numeric_limits<double>::infinity();
  for (int passes = 1; passes < kMostPasses && !settled(problem, further_, change, before, kPassShare); ++passes) {
    before = change;
    change = pass(problem, further_);
  }
  std::map<int, Vector3> lacking;  // by pair
  for (std::size_t c = 0; c < problem.contacts.size(); ++c) {
    const ContactRow& row = problem.contacts[c];
    lacking.try_emplace(row.pair, Vector3::Zero()).first->second +=
        row.R_WC * (further_.impulses[c] - solution.impulses[c]);
  }
  double sum = 0.0;
  for (const auto& of_pair : lacking) sum += of_pair.second.norm();
  return sum;
}

SolverReport IterativePredictorCorrector::solve(const ContactProblem& problem, ContactSolution& solution) {
  // With neither budget nor deadline the clock has no say.
  const double hard_s =
      options_.time_budget_s > 0.0 ? std::min(deadline_s_, clock_() + options_.time_budget_s) : deadline_s_;
  load_scale_ = changeScale(problem);
  if (!corrector_.hasRival()) predictRigidMotions(problem, solution);
  relaxation_->prepare(problem, solution);
  momentum_.prepare(problem);
  forecast_.begin();
  corrector_.prepare(problem.contacts.size(), [&](std::size_t c) -> Vector2 {
    return slidingVelocity(problem.contacts[c], solution.v, solution.impulses[c]);
  });
  corrector_.hold(problem);
  SolverReport report;
  first_change_ = std::numeric_limits<double>::infinity();
  bool released = false;
  for (bool stop = false; !stop;) {
    const MomentumDefect& met = relaxation_->relax(problem, report.iterations, corrector_, solution);
    const bool had_settled = correctContacts(problem, solution);
    ++report.iterations;
    const double until = report.iterations >= kLeastBeforePrompt ? std::min(hard_s, prompt_s_) : hard_s;
    stop = true;
    const bool solved = had_settled && balanced(problem, met, solution);
    released = 2 * report.iterations >= options_.iterations ? corrector_.releaseAll()
                                                            : solved && corrector_.releaseOverloaded();
    if (solved && !released) {
      report.stop = StopReason::kTolerance;
    } else if (report.iterations >= options_.iterations) {
      report.stop = StopReason::kIterations;
    } else if (std::isfinite(until) && clock_() >= until) {
      report.stop = StopReason::kTimeBudget;
    } else {
      stop = false;
      if (released) forecast_.begin();  // what is met from now on is of another problem
      forecast_.add(excess(met, solution));
      relaxation_->foresee(forecast_.iterationsLeft());
    }
  }
  // Cut short: what slides has kinetic friction all the same.
  if (corrector_.releaseAll() || released) pass(problem, solution);
  relaxation_->finish(problem, solution);
  return report;
}

}  // namespace tissue_contact
