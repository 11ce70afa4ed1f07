/// Gauss-Seidel sweeps under Anderson's mixing, against plain sweeps.
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <cmath>

#include "solver/iterative_predictor_corrector.h"
#include "solver/momentum_defect.h"
#include "support/pressed_block.h"

namespace tissue_contact {
namespace {

/// Without contact, under a load along x that bends it as a whole.
struct BentBlock : PressedBlock {
  explicit BentBlock(double load) : PressedBlock(0.5, 0.03) {
    keepContacts(0);
    problem.bodies[0].b.row(0).setConstant(load);
  }
};

/// |A v - b - J'lambda|, N s, after some sweeps of one block after the other, forth and back, without contact: what
/// Gauss-Seidel with Anderson's mixing must beat.
double defectOfPlainSweeps(const BentBlock& scene, int sweeps) {
  const BodySystem& body = scene.problem.bodies[0];
  const int nodes = body.K->rows();
  NodalVectors v = NodalVectors::Zero(3, nodes);
  const auto defectAt = [&](int i) -> Vector3 {
    const Vector3 elastic = body.K->offDiagonalProduct(i, v) + body.K->diagonal[i] * v.col(i);
    return body.b.col(i) - body.mass[i] * v.col(i) - body.stiffness_scale * elastic;
  };
  for (int sweep = 0; sweep < sweeps; ++sweep) {
    for (int step = 0; step < nodes; ++step) {
      const int i = sweep % 2 == 0 ? step : nodes - 1 - step;
      if ((*body.fixed)[i]) continue;
      const Matrix3 block = body.stiffness_scale * body.K->diagonal[i] + body.mass[i] * Matrix3::Identity();
      v.col(i) += block.inverse() * defectAt(i);
    }
  }
  NodalVectors defect = NodalVectors::Zero(3, nodes);
  return std::sqrt(bodyDefect(body, v, NodalVectors::Zero(3, nodes), defect));
}

TEST(MixedSweeps, LeaveFarLessThanPlainOnes) {
  for (const int sweeps : {5, 30}) {
    BentBlock scene(0.01);
    const double plain = defectOfPlainSweeps(scene, sweeps);
    const SolverReport report =
        IterativePredictorCorrector(options(sweeps, 2, 1e-15)).solve(scene.problem, scene.solution);
    if (sweeps == 5) {
      EXPECT_NEAR(report.residuals.momentum_defect_n_s, plain, 1e-9 * plain);  // nothing to mix yet
    } else {
      EXPECT_LT(report.residuals.momentum_defect_n_s, 0.02 * plain);
    }
  }
}

/// Neither a larger problem before nor a body asleep leaves a trace in the answer, not in its last bit.
TEST(MixedSweeps, KnowThisProblemAlone) {
  IterativePredictorCorrector used(options(30, 20, 1e-12));
  PressedBlock larger(0.5, 0.03);
  used.solve(larger.problem, larger.solution);
  for (const std::size_t contacts : {0, 1, 2, 5, 7, 12}) {
    PressedBlock one(0.5, 0.03);
    PressedBlock same(0.5, 0.03);
    for (PressedBlock* const scene : {&one, &same}) {
      scene->keepContacts(contacts);
      scene->problem.bodies[0].b.row(0).setConstant(0.01);
    }
    BodySystem asleep = one.problem.bodies[0];
    asleep.asleep = true;
    one.problem.bodies.insert(one.problem.bodies.begin(), asleep);
    one.solution.v.insert(one.solution.v.begin(), NodalVectors::Zero(3, asleep.mass.size()));
    for (ContactRow& row : one.problem.contacts) {
      for (int a = 0; a < row.node_count; ++a) row.nodes[a].body = 1;
    }
    const SolverReport report = used.solve(one.problem, one.solution);
    IterativePredictorCorrector(options(30, 20, 1e-12)).solve(same.problem, same.solution);
    EXPECT_GT(report.iterations, 10);
    EXPECT_EQ(one.solution.v[1], same.solution.v[0]) << contacts << " contacts";
    EXPECT_EQ(one.solution.v[0], NodalVectors::Zero(3, asleep.mass.size()));
    EXPECT_EQ(one.solution.impulses, same.solution.impulses);
  }
}

TEST(MixedSweeps, RoundOffIsNotSolved) {
  BentBlock scene(1e-19);
  const SolverReport report = IterativePredictorCorrector(options(30, 20, 1e-4)).solve(scene.problem, scene.solution);
  EXPECT_EQ(report.stop, StopReason::kTolerance);
  EXPECT_EQ(report.iterations, 1);
  EXPECT_LT(report.residuals.momentum, 1e-3);
}

}  // namespace
}  // namespace tissue_contact
