#include "tissue_contact/baselines/delassus.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include "baselines/delassus_lcp.h"
#include "baselines/delassus_sweeps.h"
#include "baselines/newton.h"

namespace tissue_contact {
namespace {

bool isotropic(const DelassusProblem& problem) {
  return std::all_of(problem.laws.begin(), problem.laws.end(),
                     [](const CoulombLaw& law) { return law.anisotropic == nullptr; });
}

void requireProblem(const DelassusProblem& problem) {
  const Eigen::Index rows = 3 * static_cast<Eigen::Index>(problem.contacts());
  if (problem.W.rows() != rows || problem.W.cols() != rows || problem.q.size() != rows ||
      problem.was_sliding.size() != problem.laws.size()) {
    throw std::invalid_argument("contact problem of " + std::to_string(problem.contacts()) + " contacts: W is " +
                                std::to_string(problem.W.rows()) + " x " + std::to_string(problem.W.cols()) +
                                ", q has " + std::to_string(problem.q.size()) + " entries, was_sliding " +
                                std::to_string(problem.was_sliding.size()) +
                                "; W must be 3n x 3n, q 3n, was_sliding n");
  }
  if (!problem.W.allFinite()) throw std::invalid_argument("contact problem: W has entries that are not finite");
  if (!problem.q.allFinite()) throw std::invalid_argument("contact problem: q has entries that are not finite");
}

void requireMethod(const DelassusProblem& problem, const SolverDescription& description) {
  SolverDescription untimed = description;  // a Delassus problem is solved to the end
  untimed.time_budget_s = 0.0;
  requireSolver(untimed, nullptr);
  const SolverMethod method = description.method;
  if (method == SolverMethod::kImpulse) {
    throw std::invalid_argument(std::string("solver \"") + solverMethodName(method) +
                                "\" needs a step of the simulation, not a contact problem; take predictor_corrector, "
                                "reference, cone4, polyhedral or condensed_lcp");
  }
  const bool any_law = method == SolverMethod::kPredictorCorrector || method == SolverMethod::kReference;
  if (!any_law && !isotropic(problem)) {
    throw std::invalid_argument(std::string("solver \"") + solverMethodName(method) +
                                "\" knows isotropic friction only; take predictor_corrector or reference");
  }
}

/// Another start for Newton where passes keep circling in a valley of the residual: the solution under 16-sided (turn 1)
/// and 64-sided (turn 2) cones, which a pivoting method finds wherever one is.
/// @return false: too large for that, or no such turn.
bool startFromCones(const DelassusProblem& problem, int turn, DelassusSolution& start) {
  constexpr int kMostUnknowns = 1000;
  SolverDescription description;
  description.cone_sides = turn == 1 ? 16 : kMaxConeSides;
  if (turn > 2 || problem.contacts() * (description.cone_sides + 2) > kMostUnknowns) return false;
  solveCondensedLcp(problem, description, start);
  return true;
}

/// Newton's method from where the passes are, then from the cones.
/// @return it met the tolerance: then `solution` is its answer.
bool finish(const DelassusProblem& problem, double tolerance, int attempt, int& iterations,
            DelassusSolution& solution) {
  DelassusSolution start = solution;
  bool another = true;
  for (bool cones = false; another; cones = true) {
    DelassusSolution answer;
    iterations += finishByNewton(problem, tolerance, start, answer);
    if (computeResiduals(problem, answer.r).scaled_natural_map <= tolerance) {
      solution = answer;
      return true;
    }
    another = !cones && startFromCones(problem, attempt, start);
  }
  return false;
}

/// Passes. Where they stall, Newton tries to finish, ever more rarely; where it fails, they go on as if nothing had been.
int solveBySweeps(const DelassusProblem& problem, const SolverDescription& description, DelassusSolution& solution) {
  constexpr int kPatience = 100;  // iterations; what converges at all mostly needs fewer
  const bool true_cone = description.method == SolverMethod::kPredictorCorrector;
  // A rival's answer is not one of the true cone: it is done when it repeats itself.
  const double settled = true_cone ? 0.0 : 0.1 * description.tolerance;
  ContactSweeps sweeps(problem, description, solution);
  int iterations = 0;
  int turn = description.iterations;
  // Newton factors a matrix of all unknowns: where there are many, passes get more time before.
  if (true_cone && isotropic(problem)) turn = std::max(kPatience, 3 * problem.contacts());
  for (int attempt = 1;; ++attempt) {
    turn = std::min(turn, description.iterations - iterations);
    const SweepsReport report = sweeps.iterate(0.5 * description.tolerance, settled, turn);
    iterations += report.iterations;
    solution = sweeps.solution();
    const bool ended = report.converged || report.iterations < turn || iterations >= description.iterations;
    if (ended || finish(problem, description.tolerance, attempt, iterations, solution)) return iterations;
    turn = iterations;
  }
}

/// Sweeps to come near, then Newton, in turns, until the scaled natural map is <= tolerance or description.iterations
/// turns are over. With an anisotropic law: sweeps alone.
/// @return sweeps and Newton steps made.
int solveReference(const DelassusProblem& problem, const SolverDescription& description, double tolerance,
                   DelassusSolution& solution) {
  constexpr int kFirstSweeps = 20;  // most problems are near enough for Newton after these
  constexpr int kMostSweeps = 1280;
  constexpr int kPatience = 8;  // turns without halving the residual: there is no solution to be had, or none for us
  const bool with_newton = isotropic(problem);
  ContactSweeps sweeps(problem, description, solution);
  int iterations = 0;
  double best = std::numeric_limits<double>::infinity();
  const auto offer = [&](const DelassusSolution& candidate) {
    const double map = computeResiduals(problem, candidate.r).scaled_natural_map;
    if (map < best) solution = candidate;
    best = std::min(best, map);
  };
  const auto polishAndOffer = [&](const DelassusSolution& start) {
    DelassusSolution answer;
    iterations += finishByNewton(problem, tolerance, start, answer);
    offer(answer);
  };
  double halved = best;
  int idle = 0;
  int length = kFirstSweeps;
  for (int turn = 0; turn < description.iterations && !(best <= tolerance) && idle < kPatience; ++turn) {
    if (best < 0.5 * halved) {
      halved = best;
      idle = 0;
    } else if (turn > 0) {
      ++idle;
    }
    iterations += sweeps.iterate(0.1 * tolerance, 0.0, length).iterations;
    offer(sweeps.solution());
    length = std::min(2 * length, kMostSweeps);
    if (best <= tolerance || !with_newton) continue;
    polishAndOffer(sweeps.solution());
    DelassusSolution start;
    if (best > tolerance && turn > 0 && startFromCones(problem, turn, start)) polishAndOffer(start);
  }
  return iterations;
}

}  // namespace

DelassusReport solveDelassus(const DelassusProblem& problem, const SolverDescription& description,
                             DelassusSolution& solution) {
  constexpr double kReferenceTolerance = 1e-10;  // at least, whatever a scene gives for its steps
  requireProblem(problem);
  requireMethod(problem, description);
  DelassusReport report;
  double tolerance = description.tolerance;
  switch (description.method) {
    case SolverMethod::kReference:
      tolerance = std::min(tolerance, kReferenceTolerance);
      report.iterations = solveReference(problem, description, tolerance, solution);
      break;
    case SolverMethod::kCondensedLcp:
      report.iterations = solveCondensedLcp(problem, description, solution);
      break;
    default:
      report.iterations = solveBySweeps(problem, description, solution);
  }
  report.overflowed = !solution.r.allFinite() || !solution.u.allFinite();
  if (report.overflowed) {
    solution.r.setZero(problem.q.size());
    solution.u = problem.q;
    solution.states.assign(problem.laws.size(), ContactState::kOpen);
  }
  report.residuals = computeResiduals(problem, solution.r);
  // Velocities whose squares overflow are no unit: any answer would meet the tolerance in it.
  const bool has_unit = std::isfinite(problem.q.norm());
  report.converged = has_unit && !report.overflowed && report.residuals.scaled_natural_map <= tolerance;
  return report;
}

}  // namespace tissue_contact
