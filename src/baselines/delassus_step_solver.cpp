#include <limits>
#include <stdexcept>

#include "baselines/delassus_system.h"
#include "baselines/step_solvers.h"

namespace tissue_contact {
namespace {

class DelassusStepSolver : public ContactSolver {
 public:
  explicit DelassusStepSolver(const SolverDescription& description) : description_(description) {}

  SolverReport solve(const ContactProblem& problem, ContactSolution& solution) override {
    try {
      return solveExactly(problem, solution);
    } catch (const std::runtime_error&) {     // A is not positive definite, or numbers overflow
    } catch (const std::invalid_argument&) {  // values that are not finite, or too many contacts for the method
    }
    // A step without a solution, not the end of the run.
    for (NodalVectors& v : solution.v) v.setConstant(std::numeric_limits<double>::quiet_NaN());
    return {};
  }

 private:
  SolverReport solveExactly(const ContactProblem& problem, ContactSolution& solution) {
    const DelassusSystem system(problem);
    const auto count = static_cast<Eigen::Index>(problem.contacts.size());
    DelassusSolution answer = {VectorX(3 * count), VectorX::Zero(3 * count), solution.states};
    for (Eigen::Index c = 0; c < count; ++c) answer.r.segment<3>(3 * c) = solution.impulses[c];
    SolverReport report;
    report.stop = StopReason::kTolerance;
    if (count > 0) {
      const DelassusReport solved = solveDelassus(system.problem(), description_, answer);
      if (solved.overflowed) throw std::runtime_error("no finite answer");
      report.iterations = solved.iterations;
      if (!solved.converged) report.stop = StopReason::kIterations;
    }
    for (Eigen::Index c = 0; c < count; ++c) solution.impulses[c] = answer.r.segment<3>(3 * c);
    solution.states = answer.states;
    system.recoverVelocities(answer.r, solution.v);
    return report;
  }

  SolverDescription description_;
};

}  // namespace

std::unique_ptr<ContactSolver> makeDelassusStepSolver(const SolverDescription& description) {
  return std::make_unique<DelassusStepSolver>(description);
}

}  // namespace tissue_contact
