/// The iterative predictor-corrector against closed forms, against its own residuals and on bad options.
#include "tissue_contact/solver/iterative_predictor_corrector.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <memory>
#include <random>
#include <stdexcept>

#include "tissue_contact/tissue/tet_elasticity.h"
#include "tissue_contact/tissue/tet_mesh.h"

namespace tissue_contact {
namespace {

SolverDescription options(int iterations, int contact_passes, double tolerance,
                          RelaxationKind relaxation = RelaxationKind::kGaussSeidel) {
  SolverDescription description;
  description.iterations = iterations;
  description.contact_passes = contact_passes;
  description.tolerance = tolerance;
  description.relaxation = relaxation;
  return description;
}

/// One free node of 2 kg without elasticity, touched by one contact: W = I/2 exactly as in form A.
struct OneNode {
  BlockMatrix K;
  std::vector<bool> fixed{false};
  ContactProblem problem;
  ContactSolution solution;

  explicit OneNode(const Vector3& free_velocity, const CoulombLaw& law) {
    K.diagonal = {Matrix3::Zero()};
    K.row_start = {0, 0};
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
  EXPECT_LE(report.residuals.momentum, 1e-14);
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

/// A block pressed and sheared through barycentric contacts on its upper face.
struct PressedBlock {
  TetMesh mesh;
  std::vector<bool> fixed;
  std::unique_ptr<Elasticity::State> state;
  ContactProblem problem;
  ContactSolution solution;

  PressedBlock(double mu, double dt) {
    BlockDescription block;
    block.size_m = Vector3(0.04, 0.04, 0.02);
    block.cells = {4, 4, 2};
    mesh = makeBlockMesh(block);
    fixed = fixedNodes(mesh.positions, {PlaneRegion{}}, "block");
    const MaterialDescription material{ElasticModel::kLinear, 5e3, 0.45, 1000.0};
    state = TetElasticity(mesh.positions, mesh.tetrahedra, fixed, material).makeState();
    const auto nodes = mesh.positions.cols();
    BodySystem body;
    body.K = &state->stiffness;
    body.fixed = &fixed;
    body.stiffness_scale = dt * dt;
    body.mass = VectorX::Constant(nodes, 1e-3);
    body.b = NodalVectors::Zero(3, nodes);
    problem.dt_s = dt;
    problem.bodies = {body};
    std::mt19937 random(3);
    std::uniform_real_distribution<double> uniform(0.0, 1.0);
    for (const Triangle& triangle : boundaryTriangles(mesh.tetrahedra)) {
      bool top = true;
      for (const int node : triangle) top = top && mesh.positions(2, node) > 0.0199;
      if (!top) continue;
      ContactRow row;
      Vector3 weights(0.1 + uniform(random), 0.1 + uniform(random), 0.1 + uniform(random));
      weights /= weights.sum();
      row.node_count = 3;
      for (int i = 0; i < 3; ++i) row.nodes[i] = {0, triangle[i], weights[i]};
      row.R_WC << 0.0, 1.0, 0.0, 0.0, 0.0, -1.0, -1.0, 0.0, 0.0;  // n = -z
      row.gap_m = 1e-4 * uniform(random);
      row.required_u_n = -row.gap_m / dt;
      row.u_tool = Vector3(0.05 + 0.1 * uniform(random), 0.1, 0.05);
      row.law = {mu, mu};
      problem.contacts.push_back(row);
    }
    solution.v = {NodalVectors::Zero(3, nodes)};
    solution.impulses.assign(problem.contacts.size(), Vector3::Zero());
    solution.states.assign(problem.contacts.size(), ContactState::kOpen);
  }
};

TEST(IterativePredictorCorrector, ConvergesToTheWholeContactProblem) {
  for (const double mu : {0.0, 0.3, 1.0}) {
    PressedBlock scene(mu, 1e-3);
    IterativePredictorCorrector solver(options(5000, 2, 1e-13));
    const SolverReport report = solver.solve(scene.problem, scene.solution);
    EXPECT_TRUE(report.converged()) << "mu " << mu;
    EXPECT_LE(report.residuals.momentum, 1e-11) << "mu " << mu;
    double normal = 0.0;
    int touching = 0;
    for (std::size_t c = 0; c < scene.problem.contacts.size(); ++c) {
      normal += scene.solution.impulses[c][0] / scene.problem.dt_s;
      touching += scene.solution.states[c] != ContactState::kOpen;
    }
    EXPECT_GT(touching, 10);
    // Relative to the total normal force; speeds are of order 0.1 m/s.
    EXPECT_LE(report.residuals.adhesion_n, 0.0);
    EXPECT_LE(report.residuals.penetration_m, 1e-12);
    EXPECT_LE(report.residuals.complementarity_w, 1e-10 * normal);
    EXPECT_LE(report.residuals.cone_violation_n, 1e-12 * normal);
    EXPECT_LE(report.residuals.static_slip_m_per_s, 1e-11);
    EXPECT_LE(report.residuals.kinetic_angle_rad, 1e-6);
  }
}

TEST(IterativePredictorCorrector, FewIterationsReportTheirTrueMomentumResidual) {
  PressedBlock scene(0.5, 1e-2);
  IterativePredictorCorrector solver(options(1, 1, 1e-13));
  const SolverReport report = solver.solve(scene.problem, scene.solution);
  EXPECT_FALSE(report.converged());
  EXPECT_GT(report.residuals.momentum, 1e-3);
}

TEST(Residuals, NotANumberIsNeverTakenForZero) {
  OneNode scene(Vector3(-1.0, 0.2, 0.1), {0.5, 0.5});
  scene.solution.states = {ContactState::kStatic};
  scene.solution.v[0].setConstant(std::numeric_limits<double>::quiet_NaN());
  std::vector<NodalVectors> scratch = {NodalVectors::Zero(3, 1)};
  const Residuals residuals = computeResiduals(scene.problem, scene.solution, scratch);
  EXPECT_TRUE(std::isnan(residuals.momentum));
  EXPECT_TRUE(std::isnan(residuals.penetration_m));
  EXPECT_TRUE(std::isnan(residuals.complementarity_w));
  EXPECT_TRUE(std::isnan(residuals.static_slip_m_per_s));
}

TEST(IterativePredictorCorrector, WarmStartAtTheAnswerStaysThere) {
  PressedBlock scene(0.3, 1e-3);
  IterativePredictorCorrector solver(options(5000, 2, 1e-13));
  solver.solve(scene.problem, scene.solution);
  const NodalVectors v = scene.solution.v[0];
  const SolverReport again = solver.solve(scene.problem, scene.solution);
  EXPECT_LE(again.iterations, 2);
  EXPECT_LE((scene.solution.v[0] - v).norm(), 1e-11 * v.norm());
}

TEST(IterativePredictorCorrector, ContactOnFixedNodesIsLeftOpen) {
  PressedBlock scene(0.3, 1e-3);
  scene.problem.contacts.resize(1);
  int f = 0;
  for (int i = 0; i < static_cast<int>(scene.fixed.size()) && f < 3; ++i) {
    if (scene.fixed[i]) scene.problem.contacts[0].nodes[f++].node = i;
  }
  ASSERT_EQ(f, 3);
  scene.solution.impulses = {Vector3(1.0, 0.0, 0.0)};
  scene.solution.states = {ContactState::kStatic};
  IterativePredictorCorrector solver(options(10, 1, 1e-9));
  solver.solve(scene.problem, scene.solution);
  EXPECT_EQ(scene.solution.states[0], ContactState::kOpen);
  EXPECT_EQ(scene.solution.impulses[0], Vector3::Zero());
  EXPECT_TRUE(scene.solution.v[0].allFinite());
}

}  // namespace
}  // namespace tissue_contact
