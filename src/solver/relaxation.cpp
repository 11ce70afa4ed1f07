#include "solver/relaxation.h"

#include <cmath>

namespace tissue_contact {

double impulseNorm(const std::vector<Vector3>& impulses) {
  double sum = 0.0;
  for (const Vector3& impulse : impulses) sum += impulse.squaredNorm();
  return std::sqrt(sum);
}

double Relaxation::correctContacts(const ContactProblem& problem, int passes, double tolerance,
                                   ContactCorrector& corrector, ContactSolution& solution) {
  beginPasses(solution);
  const double first = contactPass(problem, corrector, solution);
  double last = first;
  for (int pass = 1; pass < passes && last > tolerance * impulseNorm(solution.impulses); ++pass) {
    last = contactPass(problem, corrector, solution);
  }
  return first;
}

}  // namespace tissue_contact
