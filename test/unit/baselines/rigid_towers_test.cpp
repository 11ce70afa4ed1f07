/// Rigid blocks piled up: W of rank 48 in 72 rows, where passes over the contacts come to a halt.
#include <gtest/gtest.h>

#include <Eigen/LU>

#include "support/tower_problem.h"

namespace tissue_contact {
namespace rigid_towers_test {

constexpr int kSeeds = 60;

TEST(RigidTowers, HaveFarLessThanFullRank) {
  Eigen::FullPivLU<Eigen::MatrixXd> factors(towerProblem(0.3, 1).W);
  factors.setThreshold(1e-10);
  EXPECT_EQ(factors.rank(), 48);
}

TEST(RigidTowers, PredictorCorrectorSolvesThem) {
  for (unsigned seed = 0; seed < kSeeds; ++seed) {
    const DelassusProblem problem = towerProblem(0.3, seed);
    SolverDescription description;
    description.tolerance = 1e-6;
    description.iterations = 1000;  // the slowest of these seeds needs about 600
    DelassusSolution solution;
    const DelassusReport report = solveDelassus(problem, description, solution);
    EXPECT_TRUE(report.converged) << "seed " << seed;
    EXPECT_LE(computeResiduals(problem, solution.r).scaled_natural_map, 1e-6) << "seed " << seed;
    EXPECT_LE(report.iterations, description.iterations) << "seed " << seed;
  }
}

}  // namespace rigid_towers_test
}  // namespace tissue_contact
