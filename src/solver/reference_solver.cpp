#include "solver/reference_solver.h"

#include <algorithm>
#include <limits>

#include "solver/delassus_states.h"
#include "solver/delassus_sweeps.h"
#include "solver/reference_newton.h"

namespace tissue_contact {
namespace {

constexpr int kFirstSweeps = 20;  // most problems are near enough for Newton after these
constexpr int kMostSweeps = 1280;
constexpr int kNewtonSteps = 20;

bool isotropic(const DelassusProblem& problem) {
  return std::all_of(problem.laws.begin(), problem.laws.end(),
                     [](const CoulombLaw& law) { return law.anisotropic == nullptr; });
}

/// Newton from the sweeps' answer, contacts changing over to their kinetic coefficient until all are consistent.
int polish(const DelassusProblem& problem, double tolerance, VectorX& mu, VectorX& r) {
  int steps = 0;
  NewtonReport newton;
  do {
    newton = solveByNewton(problem, mu, tolerance, kNewtonSteps, r);
    steps += newton.steps;
  } while (newton.natural_map <= tolerance && releaseSliding(problem, r, tolerance, mu));
  return steps;
}

DelassusSolution answerOf(const DelassusProblem& problem, const ContactSweeps& sweeps) {
  return {sweeps.impulses(), problem.W * sweeps.impulses() + problem.q, sweeps.states()};
}

}  // namespace

int solveReference(const DelassusProblem& problem, const SolverDescription& description, double tolerance,
                   DelassusSolution& solution) {
  const double aim = 0.1 * tolerance;
  const bool with_newton = isotropic(problem);
  ContactSweeps sweeps(problem, description, solution);
  double best = std::numeric_limits<double>::infinity();
  const auto offer = [&](const DelassusSolution& candidate) {
    const double map = computeResiduals(problem, candidate.r).scaled_natural_map;
    if (map < best) solution = candidate;
    best = std::min(best, map);
  };
  int iterations = 0;
  int length = kFirstSweeps;
  for (int turn = 0; turn < description.iterations && !(best <= tolerance); ++turn) {
    iterations += iterate(sweeps, description, aim, 0.0, length).iterations;
    offer(answerOf(problem, sweeps));
    length = std::min(2 * length, kMostSweeps);
    if (best <= tolerance || !with_newton) continue;
    VectorX mu = chooseCoefficients(problem, sweeps.states());
    VectorX r = sweeps.impulses();
    iterations += polish(problem, aim, mu, r);
    offer(answerWith(problem, mu, r, tolerance));
  }
  return iterations;
}

}  // namespace tissue_contact
