#include "solver/delassus_step_solver.h"

#include <limits>
#include <stdexcept>

namespace tissue_contact {

SolverReport DelassusStepSolver::solve(const ContactProblem& problem, ContactSolution& solution) {
  try {
    return solveExactly(problem, solution);
  } catch (const std::runtime_error&) {     // A is not positive definite
  } catch (const std::invalid_argument&) {  // values that are not finite, or too many contacts for the method
  }
  // A step without an answer, not the end of the run.
  for (NodalVectors& v : solution.v) v.setConstant(std::numeric_limits<double>::quiet_NaN());
  return {};
}

SolverReport DelassusStepSolver::solveExactly(const ContactProblem& problem, ContactSolution& solution) {
  const DelassusSystem system(problem);
  const std::size_t count = problem.contacts.size();
  DelassusSolution answer;
  answer.r.resize(3 * static_cast<Eigen::Index>(count));
  for (std::size_t c = 0; c < count; ++c) {
    answer.r.segment<3>(3 * static_cast<Eigen::Index>(c)) = solution.impulses[c];
  }
  answer.u = VectorX::Zero(answer.r.size());
  answer.states = solution.states;
  SolverReport report;
  report.stop = StopReason::kTolerance;
  if (count > 0) {
    const DelassusReport solved = solveDelassus(system.problem(), description_, answer);
    report.iterations = solved.iterations;
    if (!solved.converged) report.stop = StopReason::kIterations;
  }
  for (std::size_t c = 0; c < count; ++c) {
    solution.impulses[c] = answer.r.segment<3>(3 * static_cast<Eigen::Index>(c));
    solution.states[c] = answer.states[c];
  }
  system.recoverVelocities(answer.r, solution.v);
  scratch_.resize(problem.bodies.size());
  memory_ = Memory();
  for (std::size_t k = 0; k < problem.bodies.size(); ++k) {
    scratch_[k].resize(3, problem.bodies[k].K->rows());
    memory_.per_nodes += scratch_[k].size() * sizeof(double);
  }
  memory_.per_contacts = 9 * count * count * sizeof(double);
  report.residuals = computeResiduals(problem, solution, scratch_);
  return report;
}

}  // namespace tissue_contact
