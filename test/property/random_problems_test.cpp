/// @file
/// Random symmetric positive definite contact problems: the answer exists; who finds it, and whether what is found
/// obeys the laws. benchmark/drivers/random_problems.cpp is the large version.
#include <gtest/gtest.h>

#include <random>

#include "support/random_contact_problem.h"

namespace tissue_contact {
namespace {

struct SizeClass {
  int contacts;
  int problems;
};
constexpr SizeClass kClasses[] = {{1, 400}, {3, 300}, {10, 150}, {30, 40}, {100, 4}};

/// 0 to 1.5.
double frictionOf(unsigned seed) {
  std::mt19937 random(seed);
  return std::uniform_real_distribution<double>(0.0, 1.5)(random);
}

TEST(RandomProblems, PredictorCorrectorReachesTheResidual) {
  for (const SizeClass& size : kClasses) {
    int solved = 0;
    for (int k = 0; k < size.problems; ++k) {
      const DelassusProblem problem = randomContactProblem(size.contacts, frictionOf(k), k);
      DelassusSolution solution;
      const DelassusReport report = solveDelassus(problem, solver(SolverMethod::kPredictorCorrector, 1e-8), solution);
      solved += report.converged ? 1 : 0;
      // Converged or not, every impulse lies in its cone: right at sticking to a billionth (SlidingSearch), which compilers
      // differ in, else to round-off.
      EXPECT_LE(report.residuals.cone_violation_n_s, 1e-9 * solution.r.norm());
      EXPECT_LE(report.residuals.adhesion_n_s, 1e-15 * solution.r.norm());
    }
    // Near mu = 1.5 a few small problems have no answer that sweeps are attracted by.
    EXPECT_GE(solved, size.problems - size.problems / 50) << size.contacts << " contacts";
  }
}

TEST(RandomProblems, ModerateFrictionIsAlwaysSolvedAndAgreesWithTheReference) {
  for (const SizeClass& size : kClasses) {
    for (int k = 0; k < size.problems / 2; ++k) {
      const DelassusProblem problem = randomContactProblem(size.contacts, 0.3 * frictionOf(k), 1000 + k);
      DelassusSolution found;
      DelassusSolution exact;
      EXPECT_TRUE(solveDelassus(problem, solver(SolverMethod::kPredictorCorrector, 1e-9), found).converged);
      const DelassusReport reference = solveDelassus(problem, solver(SolverMethod::kReference, 1e-10), exact);
      EXPECT_TRUE(reference.converged);
      EXPECT_LE(reference.residuals.friction_power_j, 1e-10);  // round-off where nothing slides
      // W has full rank; condition up to 10^4.
      EXPECT_LE((found.r - exact.r).norm(), 1e-4 * exact.r.norm()) << size.contacts << " contacts, problem " << k;
    }
  }
}

TEST(RandomProblems, RivalsSolveTheirOwnConeAndMissTheTrueOne) {
  for (const SolverMethod method : {SolverMethod::kCone4, SolverMethod::kPolyhedral, SolverMethod::kCondensedLcp}) {
    int hit = 0;
    for (int k = 0; k < 40; ++k) {
      const DelassusProblem problem = randomContactProblem(6, 0.5, 2000 + k);
      DelassusSolution solution;
      const DelassusReport report = solveDelassus(problem, solver(method, 1e-8), solution);
      hit += report.converged ? 1 : 0;
      // Signorini's law and the cone hold; only the direction of friction is wrong.
      EXPECT_LE(report.residuals.penetration_m_per_s, 1e-6) << solverMethodName(method) << k;
      EXPECT_LE(report.residuals.complementarity_j, 1e-6) << solverMethodName(method) << k;
      EXPECT_LE(report.residuals.cone_violation_n_s, 1e-9) << solverMethodName(method) << k;
      EXPECT_LE(report.residuals.friction_power_j, 1e-9) << solverMethodName(method) << k;
    }
    EXPECT_LT(hit, 20) << solverMethodName(method);
  }
}

}  // namespace
}  // namespace tissue_contact
