#include "baselines/delassus_sweeps.h"

#include "baselines/natural_map.h"
#include "baselines/rival_contact.h"

namespace tissue_contact {
namespace {

/// Both from the first contact to the last: against a pass forth and one back this halves the iterations, on towers of
/// blocks, published and random problems, in any order of the contacts (doc/solvers.md).
constexpr int kPassesPerIteration = 2;

/// Steps mixed. Random problems need as many iterations with 5 or 20; degenerate ones vary, 10 was never bad.
constexpr int kAndersonDepth = 10;

}  // namespace

ContactSweeps::ContactSweeps(const DelassusProblem& problem, const SolverDescription& description,
                             const DelassusSolution& warm_start)
    : problem_(problem), corrector_(rivalContactSolver(description)), mixing_(kAndersonDepth) {
  const std::size_t contacts = problem.laws.size();
  now_.states = warm_start.states;
  if (now_.states.size() != contacts) now_.states.assign(contacts, ContactState::kOpen);
  const VectorX& u = warm_start.u.size() == problem.q.size() ? warm_start.u : problem.q;
  corrector_.prepare(contacts,
                     [&u](std::size_t c) -> Vector2 { return u.segment<2>(3 * static_cast<Eigen::Index>(c) + 1); });
  restart(warm_start.r.size() == problem.q.size() ? warm_start.r : VectorX(VectorX::Zero(problem.q.size())));
}

void ContactSweeps::restart(const VectorX& r) {
  now_.r = r;
  now_.u = problem_.q;
  now_.u.noalias() += problem_.W * now_.r;
}

void ContactSweeps::correct(Eigen::Index contact) {
  auto r = now_.r.segment<3>(3 * contact);
  const Matrix3 W = problem_.W.block<3, 3>(3 * contact, 3 * contact);
  if (!(W(0, 0) > 0.0)) {  // nothing of it can move: no impulse would do anything
    r.setZero();
    return;
  }
  const Vector3 old = r;
  const Vector3 q = now_.u.segment<3>(3 * contact) - W * old;
  ContactState& state = now_.states[contact];
  const ContactAnswer answer =
      corrector_.solve(contact, W, q, problem_.laws[contact], problem_.was_sliding[contact], state);
  state = answer.state;
  if (answer.impulse == old) return;
  now_.u.noalias() += problem_.W.middleCols<3>(3 * contact) * (answer.impulse - old);
  r = answer.impulse;
}

SweepsReport ContactSweeps::iterate(double tolerance, double settled, int iterations) {
  SweepsReport report;
  while (report.iterations < iterations) {
    const VectorX start = now_.r;
    for (int pass = 0; pass < kPassesPerIteration; ++pass) {
      for (Eigen::Index c = 0; c < problem_.contacts(); ++c) correct(c);
    }
    ++report.iterations;
    report.converged = scaledNaturalMap(problem_, now_.r, now_.u) <= tolerance;
    const double change = (now_.r - start).norm();
    if (report.converged || !(change > settled * now_.r.norm())) break;
    // What is returned is always the outcome of a pass: inside the cones.
    if (report.iterations < iterations) restart(mixing_.next(start, now_.r));
  }
  return report;
}

DelassusSolution ContactSweeps::solution() const { return {now_.r, problem_.W * now_.r + problem_.q, now_.states}; }

}  // namespace tissue_contact
