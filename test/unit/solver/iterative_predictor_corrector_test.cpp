/// The iterative predictor-corrector against closed forms, against its own residuals and on bad options.
#include "solver/iterative_predictor_corrector.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <stdexcept>
#include <string>

#include "support/pressed_block.h"

namespace tissue_contact {
namespace iterative_predictor_corrector_test {

/// One free node of 2 kg without elasticity, touched by one contact: W = I/2 exactly as in form A.
struct OneNode {
  BlockMatrix K;
  std::vector<bool> fixed{false};
  ContactProblem problem;
  ContactSolution solution;

  explicit OneNode(const Vector3& free_velocity, const CoulombLaw& law) {
    K = BlockMatrix::forTetrahedra({}, fixed);
    BodySystem body;
    body.K = &K;
    body.fixed = &fixed;
    body.mass = VectorX::Constant(1, 2.0);
    body.b = 2.0 * free_velocity;
    problem.dt_s = 1.0;
    problem.bodies = {body};
    ContactRow row;
    row.nodes[0] = {0, 0, 1.0};
    row.node_count = 1;
    row.law = law;
    problem.contacts = {row};
    solution.v = {NodalVectors::Zero(3, 1)};
    solution.impulses = {Vector3::Zero()};
    solution.states = {ContactState::kOpen};
  }
};

TEST(IterativePredictorCorrector, FormASticks) {
  OneNode scene(Vector3(-1.0, 0.2, 0.1), {0.5, 0.5});
  IterativePredictorCorrector solver(options(10, 1, 1e-14));
  const SolverReport report = solver.solve(scene.problem, scene.solution);
  EXPECT_TRUE(report.converged());
  EXPECT_EQ(scene.solution.states[0], ContactState::kStatic);
  EXPECT_LE((scene.solution.impulses[0] - Vector3(2.0, -0.4, -0.2)).norm(), 1e-14);
  EXPECT_LE(scene.solution.v[0].norm(), 1e-14);
  EXPECT_LE(residualsOf(scene).momentum, 1e-14);
}

TEST(IterativePredictorCorrector, FormASlides) {
  OneNode scene(Vector3(-1.0, 1.2, 1.6), {0.5, 0.5});
  IterativePredictorCorrector solver(options(10, 1, 1e-14));
  solver.solve(scene.problem, scene.solution);
  EXPECT_EQ(scene.solution.states[0], ContactState::kKinetic);
  EXPECT_LE((scene.solution.impulses[0] - Vector3(2.0, -0.6, -0.8)).norm(), 1e-14);
  EXPECT_LE((scene.solution.v[0].col(0) - Vector3(0.0, 0.9, 1.2)).norm(), 1e-14);
}

TEST(IterativePredictorCorrector, MovingToolCarriesAStaticNodeAlong) {
  OneNode scene(Vector3(-1.0, 0.0, 0.0), {0.5, 0.5});
  scene.problem.contacts[0].u_tool = Vector3(0.0, 0.1, 0.0);
  IterativePredictorCorrector solver(options(10, 1, 1e-14));
  solver.solve(scene.problem, scene.solution);
  EXPECT_EQ(scene.solution.states[0], ContactState::kStatic);
  EXPECT_LE((scene.solution.v[0].col(0) - Vector3(0.0, 0.1, 0.0)).norm(), 1e-14);
}

TEST(IterativePredictorCorrector, RejectsBadOptions) {
  EXPECT_THROW(IterativePredictorCorrector(options(0, 1, 1e-5)), std::invalid_argument);
  EXPECT_THROW(IterativePredictorCorrector(options(1, 0, 1e-5)), std::invalid_argument);
  EXPECT_THROW(IterativePredictorCorrector(options(1, 1, std::numeric_limits<double>::quiet_NaN())),
               std::invalid_argument);
}

class Relaxations : public ::testing::TestWithParam<RelaxationKind> {};

TEST_P(Relaxations, ConvergeToTheWholeContactProblem) {
  for (const double mu : {0.0, 0.3, 1.0}) {
    PressedBlock scene(mu, 1e-3);
    IterativePredictorCorrector solver(options(5000, 2, 1e-13, GetParam()));
    const SolverReport report = solver.solve(scene.problem, scene.solution);
    EXPECT_TRUE(report.converged()) << "mu " << mu;
    EXPECT_LE(residualsOf(scene).momentum, 1e-11) << "mu " << mu;
    double normal = 0.0;
    int touching = 0;
    for (std::size_t c = 0; c < scene.problem.contacts.size(); ++c) {
      normal += scene.solution.impulses[c][0] / scene.problem.dt_s;
      touching += scene.solution.states[c] != ContactState::kOpen;
    }
    EXPECT_GT(touching, 10);
    // Relative to the total normal force; speeds are of order 0.1 m/s.
    EXPECT_LE(residualsOf(scene).adhesion_n, 0.0);
    EXPECT_LE(residualsOf(scene).penetration_m, 1e-12);
    EXPECT_LE(residualsOf(scene).complementarity_w, 1e-10 * normal);
    EXPECT_LE(residualsOf(scene).cone_violation_n, 1e-12 * normal);
    EXPECT_LE(residualsOf(scene).static_slip_m_per_s, 1e-11);
    EXPECT_LE(residualsOf(scene).kinetic_angle_rad, 1e-6);
  }
}

TEST_P(Relaxations, WarmStartAtTheAnswerStaysThere) {
  PressedBlock scene(0.3, 1e-3);
  IterativePredictorCorrector solver(options(5000, 2, 1e-13, GetParam()));
  solver.solve(scene.problem, scene.solution);
  const NodalVectors v = scene.solution.v[0];
  const SolverReport again = solver.solve(scene.problem, scene.solution);
  EXPECT_LE(again.iterations, 2);
  EXPECT_LE((scene.solution.v[0] - v).norm(), 1e-11 * v.norm());
}

TEST_P(Relaxations, ContactOnFixedNodesIsLeftOpen) {
  PressedBlock scene(0.3, 1e-3);
  scene.problem.contacts.resize(1);
  int f = 0;
  for (int i = 0; i < static_cast<int>(scene.fixed.size()) && f < 3; ++i) {
    if (scene.fixed[i]) scene.problem.contacts[0].nodes[f++].node = i;
  }
  ASSERT_EQ(f, 3);
  scene.solution.impulses = {Vector3(1.0, 0.0, 0.0)};
  scene.solution.states = {ContactState::kStatic};
  IterativePredictorCorrector solver(options(10, 1, 1e-9, GetParam()));
  solver.solve(scene.problem, scene.solution);
  EXPECT_EQ(scene.solution.states[0], ContactState::kOpen);
  EXPECT_EQ(scene.solution.impulses[0], Vector3::Zero());
  EXPECT_TRUE(scene.solution.v[0].allFinite());
}

TEST_P(Relaxations, DampingMatrixIsPartOfTheSystem) {
  PressedBlock scene(0.3, 1e-3);
  PressedBlock same(0.3, 1e-3);
  const BlockMatrix D = same.state->stiffness;
  same.problem.bodies[0].stiffness_scale = 0.25e-6;
  same.problem.bodies[0].D = &D;
  same.problem.bodies[0].damping_scale = 0.75e-6;
  IterativePredictorCorrector(options(5000, 2, 1e-13, GetParam())).solve(scene.problem, scene.solution);
  IterativePredictorCorrector(options(5000, 2, 1e-13, GetParam())).solve(same.problem, same.solution);
  EXPECT_LE((scene.solution.v[0] - same.solution.v[0]).norm(), 1e-10 * scene.solution.v[0].norm());
}

/// A node of each of two blocks' upper faces tied by a contact row: action equals reaction.
TEST_P(Relaxations, TwoBodiesFeelOppositeImpulses) {
  PressedBlock scene(0.5, 1e-3);
  scene.problem.bodies.push_back(scene.problem.bodies[0]);
  scene.solution.v.push_back(scene.solution.v[0]);
  ContactRow row = scene.problem.contacts[0];
  row.node_count = 2;
  row.nodes[1] = {1, row.nodes[0].node, -1.0};
  row.nodes[0].weight = 1.0;
  row.u_tool.setZero();
  row.required_u_n = 0.01;
  scene.problem.contacts = {row};
  scene.solution.impulses.resize(1);
  scene.solution.states.resize(1);
  IterativePredictorCorrector solver(options(5000, 2, 1e-14, GetParam()));
  solver.solve(scene.problem, scene.solution);
  EXPECT_LE(residualsOf(scene).momentum, 1e-11);
  EXPECT_GT(scene.solution.impulses[0][0], 0.0);
  EXPECT_NEAR(relativeVelocity(row, scene.solution.v)[0], 0.01, 1e-12);
  EXPECT_LE((scene.solution.v[0] + scene.solution.v[1]).norm(), 1e-10 * scene.solution.v[0].norm());
}

/// Jaws squeeze a body that nothing else holds with forty times its weight: what momentum lacks in all is a part of the weight, not
/// of the squeeze.
TEST(IterativePredictorCorrector, ALooseBodyIsBalancedAgainstWhatMovesIt) {
  constexpr double kDt = 0.01;
  constexpr double kTolerance = 0.03;
  const Vector3 gravity(0.0, -0.8, -1.2);
  const auto lacks = [&](bool is_loose) {
    PressedBlock scene(0.5, kDt);
    scene.fixed.assign(scene.fixed.size(), false);
    const MaterialDescription material{ElasticModel::kLinear, 5e3, 0.45, 1000.0};
    scene.state = TetElasticity(scene.mesh.positions, scene.mesh.tetrahedra, scene.fixed, material).makeState();
    BodySystem& body = scene.problem.bodies[0];
    body.K = &scene.state->stiffness;
    body.b = kDt * gravity * body.mass.transpose();
    const double weight_n_s = body.b.rowwise().sum().norm();
    if (is_loose) body.net_change_n_s = weight_n_s;
    const std::size_t above = scene.problem.contacts.size();
    for (std::size_t c = 0; c < above; ++c) {  // each again from below, where the mesh is the same
      ContactRow row = scene.problem.contacts[c];
      row.R_WC.col(0) *= -1.0;
      row.R_WC.col(2) *= -1.0;
      row.u_tool = Vector3(0.15, 0.0, 0.0);
      for (int a = 0; a < row.node_count; ++a) row.nodes[a].node -= 2 * 25;  // two layers of 5 x 5 nodes down
      scene.problem.contacts.push_back(row);
    }
    scene.solution.impulses.assign(2 * above, Vector3::Zero());
    scene.solution.states.assign(2 * above, ContactState::kOpen);
    IterativePredictorCorrector(options(1000, 20, kTolerance)).solve(scene.problem, scene.solution);
    double squeeze_n_s = 0.0;
    for (const Vector3& impulse : scene.solution.impulses) squeeze_n_s += impulse.norm();
    EXPECT_GT(squeeze_n_s, 40.0 * weight_n_s);
    return residualsOf(scene).net_defect_n_s / weight_n_s;
  };
  EXPECT_LT(lacks(true),
            5.0 * kTolerance);  // of the weight and of what contacts bring, as much again, two tolerances each
  EXPECT_GT(lacks(false), 10.0 * kTolerance);
}

INSTANTIATE_TEST_SUITE_P(Each, Relaxations, ::testing::Values(RelaxationKind::kGaussSeidel, RelaxationKind::kCholesky),
                         [](const auto& parameter) {
                           return std::string(parameter.param == RelaxationKind::kCholesky ? "Cholesky"
                                                                                           : "GaussSeidel");
                         });

TEST(LaggedCholesky, GivesTheAnswerOfGaussSeidelWithAFactorOfAnotherStep) {
  PressedBlock scene(0.5, 1e-3);
  IterativePredictorCorrector lagged(options(200, 10, 1e-12, RelaxationKind::kCholesky));
  lagged.solve(scene.problem, scene.solution);
  // What has changed since is too little for a new factor.
  scene.problem.bodies[0].stiffness_scale *= 1.2;
  PressedBlock same(0.5, 1e-3);
  same.problem.bodies[0].stiffness_scale *= 1.2;
  const SolverReport report = lagged.solve(scene.problem, scene.solution);
  IterativePredictorCorrector(options(20000, 2, 1e-14)).solve(same.problem, same.solution);
  EXPECT_TRUE(report.converged());
  EXPECT_LE(residualsOf(scene).momentum, 1e-9);
  EXPECT_LE((scene.solution.v[0] - same.solution.v[0]).norm(), 1e-9 * same.solution.v[0].norm());
}

/// A stiffness that has grown tenfold in one direction makes the old factor's relaxation diverge in it, out of a share of
/// the answer that is too small to be seen at first.
TEST(LaggedCholesky, RenewsAFactorThatDrivesTheAnswerApart) {
  OneNode scene(Vector3(1.0, 0.0, 1e-3), {});
  scene.problem.contacts.clear();
  scene.solution.impulses.clear();
  scene.solution.states.clear();
  scene.problem.bodies[0].mass[0] = 1e-6;
  scene.problem.bodies[0].b = Vector3(1.0, 0.0, 1e-3);
  scene.problem.bodies[0].stiffness_scale = 1.0;
  scene.K.diagonal[0] = Matrix3::Identity();
  IterativePredictorCorrector solver(options(30, 2, 1e-12, RelaxationKind::kCholesky));
  solver.solve(scene.problem, scene.solution);
  scene.K.diagonal[0](2, 2) = 10.0;
  scene.solution.v[0].setZero();
  const SolverReport report = solver.solve(scene.problem, scene.solution);
  EXPECT_TRUE(report.converged());
  EXPECT_LE(residualsOf(scene).momentum, 1e-11);
  EXPECT_NEAR(scene.solution.v[0](2, 0), 1e-4, 1e-10);
}

TEST(LaggedCholesky, NeedsFewIterationsWhereGaussSeidelStalls) {
  PressedBlock stiff(0.5, 0.03);
  PressedBlock same(0.5, 0.03);
  const SolverReport sweeps = IterativePredictorCorrector(options(400, 2, 1e-9)).solve(same.problem, same.solution);
  const SolverReport factored = IterativePredictorCorrector(options(400, 20, 1e-9, RelaxationKind::kCholesky))
                                    .solve(stiff.problem, stiff.solution);
  EXPECT_TRUE(factored.converged());
  EXPECT_LE(10 * factored.iterations, sweeps.iterations);
}

TEST(IterativePredictorCorrector, StopsWhenTheTimeBudgetIsSpentAndSaysSo) {
  PressedBlock scene(0.5, 1e-2);
  SolverOptions timed = options(5000, 2, 1e-15);
  timed.time_budget_s = 2.5;
  double seconds = 0.0;
  const auto clock = [&] { return seconds += 1.0; };
  const SolverReport report = IterativePredictorCorrector(timed, clock).solve(scene.problem, scene.solution);
  EXPECT_EQ(report.stop, StopReason::kTimeBudget);
  EXPECT_EQ(report.iterations, 3);
  EXPECT_GT(residualsOf(scene).momentum, 0.0);
  EXPECT_THROW(IterativePredictorCorrector{timed}, std::invalid_argument);  // no clock
}

/// Nodes each held by a contact of its own: the case of MICA's projector.
TEST(IterativePredictorCorrector, HeldNodesMoveWithTheTool) {
  PressedBlock scene(2.0, 1e-3);
  std::vector<ContactRow> rows;
  std::vector<bool> used(scene.fixed.size(), false);
  for (const ContactRow& row : scene.problem.contacts) {
    for (const RowNode& at : row.nodes) {
      if (at.weight == 0.0 || used[at.node]) continue;
      used[at.node] = true;
      rows.push_back(row);
      rows.back().nodes[0] = {0, at.node, 1.0};
      rows.back().node_count = 1;
      rows.back().required_u_n = 0.05;
      rows.back().u_tool = Vector3(0.0, 0.01, -0.02);
    }
  }
  scene.problem.contacts = rows;
  scene.solution.impulses.assign(rows.size(), Vector3::Zero());
  scene.solution.states.assign(rows.size(), ContactState::kOpen);
  const SolverReport report = IterativePredictorCorrector(options(5000, 2, 1e-13)).solve(scene.problem, scene.solution);
  EXPECT_TRUE(report.converged());
  EXPECT_LE(residualsOf(scene).momentum, 1e-11);
  int held = 0;
  for (std::size_t c = 0; c < rows.size(); ++c) {
    if (scene.solution.states[c] != ContactState::kStatic) continue;
    ++held;
    EXPECT_LE(relativeVelocity(rows[c], scene.solution.v).tail<2>().norm(), 1e-12);
  }
  EXPECT_GT(held, 10);
}

TEST(IterativePredictorCorrector, FewIterationsLeaveAMomentumResidual) {
  PressedBlock scene(0.5, 1e-2);
  IterativePredictorCorrector solver(options(1, 1, 1e-13));
  const SolverReport report = solver.solve(scene.problem, scene.solution);
  EXPECT_FALSE(report.converged());
  EXPECT_GT(residualsOf(scene).momentum, 1e-3);
}

TEST(Residuals, NotANumberIsNeverTakenForZero) {
  OneNode scene(Vector3(-1.0, 0.2, 0.1), {0.5, 0.5});
  scene.solution.states = {ContactState::kStatic};
  scene.solution.v[0].setConstant(std::numeric_limits<double>::quiet_NaN());
  const Residuals residuals = residualsOf(scene);
  EXPECT_TRUE(std::isnan(residuals.momentum));
  EXPECT_TRUE(std::isnan(residuals.penetration_m));
  EXPECT_TRUE(std::isnan(residuals.complementarity_w));
  EXPECT_TRUE(std::isnan(residuals.static_slip_m_per_s));
}

/// A node under the four faces around it, as a ball that rests on a vertex of coarse cells makes them: four contacts for
/// three unknowns, each of which undoes a part of what the one before it did.
OneNode vertexUnderFourFaces() {
  OneNode scene(Vector3(-1.0, 0.02, 0.01), {0.05, 0.05});
  const ContactRow row = scene.problem.contacts[0];
  scene.problem.contacts.clear();
  for (const double x : {-0.3, 0.3}) {
    for (const double y : {-0.3, 0.3}) {
      ContactRow face = row;
      const Vector3 n = Vector3(1.0, x, y).normalized();
      const Vector3 t = n.unitOrthogonal();
      face.R_WC << n, t, n.cross(t);
      scene.problem.contacts.push_back(face);
    }
  }
  scene.solution.impulses.assign(4, Vector3::Zero());
  scene.solution.states.assign(4, ContactState::kOpen);
  return scene;
}

class PassesOverContacts : public testing::TestWithParam<RelaxationKind> {
 protected:
  ContactSolution solve(OneNode scene, int iterations, int passes, double tolerance) const {
    IterativePredictorCorrector(options(iterations, passes, tolerance, GetParam()))
        .solve(scene.problem, scene.solution);
    return scene.solution;
  }
};

TEST_P(PassesOverContacts, ManyOfThemSettleWhatFewLeave) {
  const OneNode scene = vertexUnderFourFaces();
  const NodalVectors exact = solve(scene, 1000, 100, 1e-15).v[0];
  const auto error = [&](int passes) { return (solve(scene, 3, passes, 1e-15).v[0] - exact).norm(); };
  EXPECT_GT(error(2), 0.0);
  EXPECT_LT(error(20), 0.1 * error(2));
}

TEST_P(PassesOverContacts, StopOnceImpulsesSettle) {
  const OneNode scene = vertexUnderFourFaces();
  const ContactSolution one = solve(scene, 1, 100, 0.05);
  const ContactSolution never = solve(scene, 1, 100, 1e-15);
  EXPECT_NE(one.impulses, never.impulses);
  EXPECT_EQ(one.impulses, solve(scene, 1, 90, 0.05).impulses);
}

INSTANTIATE_TEST_SUITE_P(Relaxations, PassesOverContacts,
                         testing::Values(RelaxationKind::kGaussSeidel, RelaxationKind::kCholesky),
                         [](const auto& relaxation) { return std::string(relaxationName(relaxation.param)); });

}  // namespace iterative_predictor_corrector_test
}  // namespace tissue_contact
