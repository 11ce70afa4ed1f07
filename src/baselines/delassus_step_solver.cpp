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
    DelassusSystem system(problem);
    const auto count = static_cast<Eigen::Index>(problem.contacts.size());
    DelassusSolution answer = {VectorX(3 * count), VectorX::Zero(3 * count), solution.states};
    for (Eigen::Index c = 0; c < count; ++c) answer.r.segment<3>(3 * c) = solution.impulses[c];
    SolverReport report;
    report.stop = StopReason::kTolerance;
    if (count > 0) {
      if (description_.method == SolverMethod::kReference) holdStaticContacts(problem, system.problem().laws);
      do {
        const DelassusReport solved = solveDelassus(system.problem(), description_, answer);
        if (solved.overflowed) throw std::runtime_error("no finite answer");
        report.iterations += solved.iterations;
        report.stop = solved.converged ? StopReason::kTolerance : StopReason::kIterations;
      } while (releaseOverloaded(problem, answer.states, system.problem().laws));
    }
    for (Eigen::Index c = 0; c < count; ++c) solution.impulses[c] = answer.r.segment<3>(3 * c);
    solution.states = answer.states;
    system.recoverVelocities(answer.r, solution.v);
    return report;
  }

  // As the iterative predictor-corrector does (ContactCorrector::hold()): contacts that were static let go of what all others leave them only.
  // Anisotropic laws have no such form.
  static void holdStaticContacts(const ContactProblem& problem, std::vector<CoulombLaw>& laws) {
    for (std::size_t c = 0; c < laws.size(); ++c) {
      if (problem.contacts[c].was_static) laws[c].mu_kinetic = laws[c].mu_static;
    }
  }

  /// @return there were such.
  static bool releaseOverloaded(const ContactProblem& problem, const std::vector<ContactState>& states,
                                std::vector<CoulombLaw>& laws) {
    bool some = false;
    for (std::size_t c = 0; c < laws.size(); ++c) {
      const double kinetic = problem.contacts[c].law.mu_kinetic;
      if (states[c] != ContactState::kKinetic || laws[c].mu_kinetic == kinetic) continue;
      laws[c].mu_kinetic = kinetic;
      some = true;
    }
    return some;
  }

  SolverDescription description_;
};

}  // namespace

std::unique_ptr<ContactSolver> makeDelassusStepSolver(const SolverDescription& description) {
  return std::make_unique<DelassusStepSolver>(description);
}

}  // namespace tissue_contact
