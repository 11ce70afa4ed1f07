#include "solver/relaxation.h"

namespace tissue_contact {

double Relaxation::correctContacts(const ContactProblem& problem, int passes, double enough,
                                   ContactCorrector& corrector, ContactSolution& solution) {
  beginPasses(solution);
  const double first = contactPass(problem, corrector, solution);
  double last = first;
  for (int pass = 1; pass < passes && last > enough; ++pass) last = contactPass(problem, corrector, solution);
  return first;
}

}  // namespace tissue_contact
