#include "tissue_contact/solver/delassus.h"

#include <algorithm>
#include <stdexcept>

#include "solver/delassus_lcp.h"
#include "solver/delassus_sweeps.h"
#include "solver/reference_solver.h"
#include "tissue_contact/solver/contact_solver.h"

namespace tissue_contact {
namespace {

/// What the reference is at least solved to, whatever tolerance a scene gives for its steps.
constexpr double kReferenceTolerance = 1e-10;

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
  requireSolverOptions(untimed, nullptr);
  const SolverMethod method = description.method;
  if (method == SolverMethod::kImpulse) {
    throw std::invalid_argument(std::string("solver \"") + solverMethodName(method) +
                                "\" needs a step of the simulation, not a contact problem; take predictor_corrector, "
                                "reference, cone4, polyhedral or condensed_lcp");
  }
  const bool any_law = method == SolverMethod::kPredictorCorrector || method == SolverMethod::kReference;
  const auto anisotropic = [](const CoulombLaw& law) { return law.anisotropic != nullptr; };
  if (!any_law && std::any_of(problem.laws.begin(), problem.laws.end(), anisotropic)) {
    throw std::invalid_argument(std::string("solver \"") + solverMethodName(method) +
                                "\" knows isotropic friction only; take predictor_corrector or reference");
  }
}

/// Newton's method from where the passes are; at the first two attempts also from the answers under linearised cones, for
/// passes may circle in a valley of the residual. @return it met the tolerance: then `solution` is its answer.
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
    solution = {sweeps.impulses(), problem.W * sweeps.impulses() + problem.q, sweeps.states()};
    const bool ended = report.converged || report.iterations < turn || iterations >= description.iterations;
    if (ended || finish(problem, description.tolerance, attempt, iterations, solution)) return iterations;
    turn = iterations;
  }
}

}  // namespace

DelassusReport solveDelassus(const DelassusProblem& problem, const SolverDescription& description,
                             DelassusSolution& solution) {
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
  report.residuals = computeResiduals(problem, solution.r);
  report.converged = report.residuals.scaled_natural_map <= tolerance;
  return report;
}

}  // namespace tissue_contact
