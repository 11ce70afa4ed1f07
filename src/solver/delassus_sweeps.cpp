#include "solver/delassus_sweeps.h"

#include <cmath>

#include "solver/contact_corrector.h"
#include "solver/rival_contact.h"

namespace tissue_contact {
namespace {

/// Both from the first contact to the last: against a pass forth and one back this halves the iterations, on towers of
/// blocks, published and random problems, in any order of the contacts (doc/solvers.md).
constexpr int kPassesPerIteration = 2;

/// Steps mixed. Random problems need as many iterations with 5 or 20; degenerate ones vary, 10 was never bad.
constexpr int kAndersonDepth = 10;

}  // namespace

ContactSweeps::ContactSweeps(const DelassusProblem& problem, const SolverDescription& description,
                             const DelassusSolution& solution)
    : problem_(problem),
      method_(description.method),
      cone_sides_(description.cone_sides),
      units_(naturalUnits(problem)),
      states_(problem.contacts(), ContactState::kOpen),
      flips_(problem.contacts(), 0),
      previous_sliding_(problem.contacts()),
      mixing_(kAndersonDepth) {
  const bool warm = solution.r.size() == problem.q.size();
  const bool moving = solution.u.size() == problem.q.size();
  if (solution.states.size() == states_.size()) states_ = solution.states;
  restart(warm ? solution.r : VectorX(VectorX::Zero(problem.q.size())));
  for (Eigen::Index c = 0; c < problem.contacts(); ++c) {
    previous_sliding_[c] = (moving ? solution.u : problem.q).segment<2>(3 * c + 1);
  }
}

void ContactSweeps::restart(const VectorX& r) {
  r_ = r;
  u_ = problem_.q;
  u_.noalias() += problem_.W * r_;
}

void ContactSweeps::pass() {
  for (int i = 0; i < problem_.contacts(); ++i) correct(i);
}

void ContactSweeps::correct(Eigen::Index contact) {
  const Matrix3 W = problem_.W.block<3, 3>(3 * contact, 3 * contact);
  if (!(W(0, 0) > 0.0)) {  // nothing of it can move: no impulse would do anything
    r_.segment<3>(3 * contact).setZero();
    return;
  }
  const Vector3 old = r_.segment<3>(3 * contact);
  const Vector3 q = u_.segment<3>(3 * contact) - W * old;
  int& flips = flips_[contact];
  const bool kinetic_limit = problem_.was_sliding[contact] || flips > ContactCorrector::kMaxFlips;
  const CoulombLaw& law = problem_.laws[contact];
  const ContactAnswer answer =
      method_ == SolverMethod::kPredictorCorrector || method_ == SolverMethod::kReference
          ? solveCoulombContact(W, q, law, kinetic_limit)
          : solveRivalContact(method_, cone_sides_, W, q, law, kinetic_limit, previous_sliding_[contact]);
  ContactState& state = states_[contact];
  const bool both_touch = answer.state != ContactState::kOpen && state != ContactState::kOpen;
  if (both_touch && answer.state != state && flips <= ContactCorrector::kMaxFlips) ++flips;
  state = answer.state;
  if (answer.impulse == old) return;
  u_.noalias() += problem_.W.middleCols<3>(3 * contact) * (answer.impulse - old);
  r_.segment<3>(3 * contact) = answer.impulse;
}

double ContactSweeps::naturalMapNorm() const {
  double sum = 0.0;
  for (Eigen::Index c = 0; c < problem_.contacts(); ++c) {
    const double defect = contactDefect(problem_.W.block<3, 3>(3 * c, 3 * c), r_.segment<3>(3 * c),
                                        u_.segment<3>(3 * c), problem_.laws[c], problem_.was_sliding[c], units_);
    sum += defect * defect;
  }
  return std::sqrt(sum);
}

SweepsReport ContactSweeps::iterate(double tolerance, double settled, int iterations) {
  SweepsReport report;
  while (report.iterations < iterations) {
    const VectorX start = r_;
    for (int k = 0; k < kPassesPerIteration; ++k) pass();
    ++report.iterations;
    report.converged = naturalMapNorm() <= tolerance;
    const double change = (r_ - start).norm();
    if (report.converged || !(change > settled * r_.norm())) break;
    // What is returned is always the outcome of a pass: inside the cones.
    if (report.iterations < iterations) restart(mixing_.next(start, r_));
  }
  return report;
}

}  // namespace tissue_contact
