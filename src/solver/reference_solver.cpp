#include "solver/reference_solver.h"

#include <algorithm>
#include <limits>

#include "solver/delassus_lcp.h"
#include "solver/delassus_states.h"
#include "solver/delassus_sweeps.h"
#include "solver/reference_newton.h"

namespace tissue_contact {
namespace {

constexpr int kFirstSweeps = 20;  // most problems are near enough for Newton after these
constexpr int kMostSweeps = 1280;
constexpr int kNewtonSteps = 20;

DelassusSolution answerOf(const DelassusProblem& problem, const ContactSweeps& sweeps) {
  return {sweeps.impulses(), problem.W * sweeps.impulses() + problem.q, sweeps.states()};
}

}  // namespace

bool isotropic(const DelassusProblem& problem) {
  return std::all_of(problem.laws.begin(), problem.laws.end(),
                     [](const CoulombLaw& law) { return law.anisotropic == nullptr; });
}

int finishByNewton(const DelassusProblem& problem, double tolerance, const DelassusSolution& start,
                   DelassusSolution& answer) {
  const double aim = 0.1 * tolerance;
  VectorX mu = chooseCoefficients(problem, start.states);
  VectorX r = start.r;
  int steps = 0;
  NewtonReport newton;
  do {
    newton = solveByNewton(problem, mu, aim, kNewtonSteps, r);
    steps += newton.steps;
  } while (newton.natural_map <= aim && releaseSliding(problem, r, aim, mu));
  answer = answerWith(problem, mu, r, tolerance);
  return steps;
}

bool startFromCones(const DelassusProblem& problem, int turn, DelassusSolution& start) {
  constexpr int kMostUnknowns = 1000;
  SolverDescription description;
  description.cone_sides = turn == 1 ? 16 : 64;
  if (turn > 2 || problem.contacts() * (description.cone_sides + 2) > kMostUnknowns) return false;
  solveCondensedLcp(problem, description, start);
  return true;
}

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
  const auto polishAndOffer = [&](const DelassusSolution& start) {
    DelassusSolution answer;
    iterations += finishByNewton(problem, tolerance, start, answer);
    offer(answer);
  };
  constexpr int kPatience = 8;  // turns without halving the residual: there is no answer to be had, or none for us
  double halved = best;
  int idle = 0;
  int length = kFirstSweeps;
  for (int turn = 0; turn < description.iterations && !(best <= tolerance) && idle < kPatience; ++turn) {
    if (best < 0.5 * halved) {
      halved = best;
      idle = 0;
    } else if (turn > 0) {
      ++idle;
    }
    iterations += sweeps.iterate(aim, 0.0, length).iterations;
    offer(answerOf(problem, sweeps));
    length = std::min(2 * length, kMostSweeps);
    if (best <= tolerance || !with_newton) continue;
    polishAndOffer(answerOf(problem, sweeps));
    DelassusSolution start;
    if (best > tolerance && turn > 0 && startFromCones(problem, turn, start)) polishAndOffer(start);
  }
  return iterations;
}

}  // namespace tissue_contact
