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
      if (description_.method == SolverMethod::kReference) holdStaticContacts(problem, system.laws());
      do {
        const DelassusReport solved = solveDelassus(system.problem(), description_, answer);
        if (solved.overflowed) throw std::runtime_error("no finite answer");
        report.iterations += solved.iterations;
        report.stop = solved.converged ? StopReason::kTolerance : StopReason::kIterations;
      } while (release(problem, answer.states, report.stop != StopReason::kTolerance, system.laws()));
    }
    for (Eigen::Index c = 0; c < count; ++c) solution.impulses[c] = answer.r.segment<3>(3 * c);
    solution.states = answer.states;
    system.recoverVelocities(answer.r, solution.v);
    return report;
  }

  /// As the iterative predictor-corrector does (ContactCorrector::hold()): contacts that were static have the static limit until the step is
  /// solved with it, then those that slide have kinetic friction, and so on. Not with anisotropic laws.
  static void holdStaticContacts(const ContactProblem& problem, std::vector<CoulombLaw>& laws) {
    for (std::size_t c = 0; c < laws.size(); ++c) {
      if (problem.contacts[c].was_static) laws[c].mu_kinetic = laws[c].mu_static;
    }
  }

  /// Of what slides. @param all what does not as well: the step was not solved.
  /// @return some slide that were held, so that the step is to be solved again.
  static bool release(const ContactProblem& problem, const std::vector<ContactState>& states, bool all,
                      std::vector<CoulombLaw>& laws) {
    bool some = false;
    for (std::size_t c = 0; c < laws.size(); ++c) {
      const double kinetic = problem.contacts[c].law.mu_kinetic;
      if (laws[c].mu_kinetic == kinetic) continue;
      const bool slides = states[c] == ContactState::kKinetic;
      some = some || slides;
      if (slides || all) laws[c].mu_kinetic = kinetic;
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
