/// Gauss-Seidel sweeps under Anderson's mixing, against plain sweeps.
#include <gtest/gtest.h>

#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <memory>
#include <vector>

#include "solver/iterative_predictor_corrector.h"
#include "solver/momentum_defect.h"
#include "solver/relaxation.h"
#include "support/pressed_block.h"
#include "tissue/stiff_parts.h"

namespace tissue_contact {
namespace mixed_sweeps_test {

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
    IterativePredictorCorrector(options(sweeps, 2, 1e-15)).solve(scene.problem, scene.solution);
    if (sweeps == 5) {
      EXPECT_NEAR(residualsOf(scene).momentum_defect_n_s, plain, 1e-9 * plain);  // nothing to mix yet
    } else {
      EXPECT_LT(residualsOf(scene).momentum_defect_n_s, 0.02 * plain);
    }
  }
}

/// Iterations to 1e-4 of a load that bends a block, after one of two thirds of it.
int iterationsOfTheSecondStep(bool forgets) {
  BentBlock scene(0.01);
  IterativePredictorCorrector solver(options(300, 2, 1e-4));
  solver.solve(scene.problem, scene.solution);
  if (forgets) scene.solution.slow_changes.clear();
  scene.problem.bodies[0].b.row(0).setConstant(0.015);
  return solver.solve(scene.problem, scene.solution).iterations;
}

TEST(MixedSweeps, FindSoonerWhatTheStepBeforeWasSlowToFind) {
  EXPECT_LE(iterationsOfTheSecondStep(false), 0.5 * iterationsOfTheSecondStep(true));
}

/// A block of 8 x 8 x 4 cells under a load that bends it, fifty times as stiff in a ball in its middle.
struct BlockWithInclusion {
  TetMesh mesh = makeBlockMesh({Vector3(0.04, 0.04, 0.02), {8, 8, 4}, {}});
  std::vector<bool> fixed = fixedNodes(mesh.positions, {PlaneRegion{}}, "block");
  std::unique_ptr<Elasticity::State> state;
  std::vector<std::vector<int>> parts;
  ContactProblem problem;
  ContactSolution solution;

  BlockWithInclusion() {
    const MaterialDescription soft{ElasticModel::kLinear, 5e3, 0.45, 1000.0};
    ElementMaterials materials(soft);
    materials.materials.push_back(soft);
    materials.materials.back().youngs_modulus_pa *= 50.0;
    for (const Tetrahedron& element : mesh.tetrahedra) {
      Vector3 middle = Vector3::Zero();
      for (const int node : element) middle += 0.25 * mesh.positions.col(node);
      materials.of_element.push_back((middle - Vector3(0.02, 0.02, 0.012)).norm() < 0.006 ? 1 : 0);
    }
    parts = findStiffParts(mesh.positions, mesh.tetrahedra, materials);
    state = TetElasticity(mesh.positions, mesh.tetrahedra, fixed, materials).makeState();
    BodySystem body;
    body.K = &state->stiffness;
    body.fixed = &fixed;
    body.stiffness_scale = 0.03 * 0.03;
    body.mass = VectorX::Constant(mesh.positions.cols(), 1e-4);
    body.b = NodalVectors::Zero(3, mesh.positions.cols());
    for (int i = 0; i < mesh.positions.cols(); ++i) {
      if (!fixed[i]) body.b.col(i) = Vector3(1e-3, 0.0, -1e-3);
    }
    problem.dt_s = 0.03;
    problem.bodies = {body};
    solution.v = {body.b * 0.0};
  }
};

/// Answers are the same; they take fewer iterations than with coarse motions (coarse_motions.h) alone.
TEST(MixedSweeps, MoveAStiffInclusionAsOne) {
  const auto solve = [](bool as_one, BlockWithInclusion& scene) {
    scene.problem.bodies[0].stiff_parts = as_one ? &scene.parts : nullptr;
    scene.problem.bodies[0].x = &scene.mesh.positions;
    return IterativePredictorCorrector(options(1000, 2, 1e-10)).solve(scene.problem, scene.solution).iterations;
  };
  BlockWithInclusion plain, as_one;
  const int without = solve(false, plain);
  const int with = solve(true, as_one);
  EXPECT_LT(with, 0.8 * without) << with << " of " << without;
  EXPECT_LE((as_one.solution.v[0] - plain.solution.v[0]).norm(), 1e-7 * plain.solution.v[0].norm());
}

/// Contacts that stick, slide and open come out alike along whatever a step begins with.
TEST(MixedSweeps, DeflationChangesNoAnswer) {
  PressedBlock plain(0.5, 0.03), along(0.5, 0.03);
  const int nodes = along.problem.bodies[0].K->rows();
  std::srand(3);
  along.solution.slow_changes = {1e-3 * NodalVectors::Random(3, nodes)};
  for (PressedBlock* scene : {&plain, &along}) {
    const SolverReport report =
        IterativePredictorCorrector(options(2000, 20, 1e-11)).solve(scene->problem, scene->solution);
    ASSERT_EQ(report.stop, StopReason::kTolerance);
  }
  // The tolerance times what sweeps leave of a change, some hundred times as much.
  EXPECT_LE((along.solution.v[0] - plain.solution.v[0]).norm(), 1e-8 * plain.solution.v[0].norm());
  EXPECT_EQ(along.solution.states, plain.solution.states);
}

/// Of what a step begins with, nodes of contacts are left out: the sweep back comes out to the same bits.
TEST(MixedSweeps, DeflationLeavesNodesOfContactsOut) {
  const auto afterTwoSweeps = [](bool at_contacts, bool elsewhere) {
    PressedBlock scene(0.5, 0.03);
    NodalVectors u = NodalVectors::Constant(3, scene.problem.bodies[0].K->rows(), elsewhere ? 0.01 : 0.0);
    for (const ContactRow& row : scene.problem.contacts) {
      for (int a = 0; a < row.node_count; ++a) u.col(row.nodes[a].node).setConstant(at_contacts ? 0.01 : 0.0);
    }
    scene.solution.slow_changes = {u};
    IterativePredictorCorrector(options(2, 2, 1e-15)).solve(scene.problem, scene.solution);
    return scene.solution.v[0];
  };
  const NodalVectors plain = afterTwoSweeps(false, false);
  EXPECT_EQ(afterTwoSweeps(true, false), plain);
  EXPECT_NE(afterTwoSweeps(false, true), plain);
}

/// b - A v of a node, block by block.
Vector3 plainDefect(const BodySystem& body, int i, const NodalVectors& v) {
  Vector3 defect = body.b.col(i) - body.mass[i] * v.col(i);
  const auto subtract = [&](const BlockMatrix& matrix, double scale) {
    defect -= scale * (matrix.diagonal[i] * v.col(i));
    defect -= scale * matrix.offDiagonalProduct(i, v);
  };
  subtract(*body.K, body.stiffness_scale);
  if (body.D != nullptr) subtract(*body.D, body.damping_scale);
  return defect;
}

/// Four rows at a time with half the blocks stored, against node by node and block by block.
TEST(BodyDefect, IsThePlainOne) {
  for (const bool damped : {false, true}) {
    PressedBlock scene(0.5, 0.03);
    BodySystem& body = scene.problem.bodies[0];
    body.b.setRandom();
    if (damped) {
      body.D = body.K;
      body.damping_scale = 2e-3;
    }
    NodalVectors v = NodalVectors::Random(3, body.K->rows());
    for (int i = 0; i < body.K->rows(); ++i) {
      if (scene.fixed[i]) v.col(i).setZero();
    }
    NodalVectors expected(3, body.K->rows());
    for (int i = 0; i < body.K->rows(); ++i) {
      expected.col(i) = scene.fixed[i] ? Vector3(Vector3::Zero()) : plainDefect(body, i, v);
    }
    NodalVectors defect = NodalVectors::Zero(3, body.K->rows());
    const double square = bodyDefect(body, v, defect, defect);  // of impulses in the place of the defect
    EXPECT_LE((defect - expected).cwiseAbs().maxCoeff(), 1e-14 * expected.cwiseAbs().maxCoeff());
    EXPECT_NEAR(square, expected.squaredNorm(), 1e-13 * square);
  }
}

/// A sweep forth and one back as in the text-book, each node's defect computed in full; between the two contacts move
/// `moved` by `by`.
NodalVectors plainPair(const ContactProblem& problem, const std::vector<int>& moved, const Vector3& by) {
  const BodySystem& body = problem.bodies[0];
  const int nodes = body.K->rows();
  NodalVectors v = NodalVectors::Zero(3, nodes);
  for (int step = 0; step < 2 * nodes; ++step) {
    if (step == nodes) {
      for (const int node : moved) v.col(node) += by;
    }
    const int i = step < nodes ? step : 2 * nodes - 1 - step;
    if ((*body.fixed)[i]) continue;
    Matrix3 block = body.stiffness_scale * body.K->diagonal[i] + body.mass[i] * Matrix3::Identity();
    if (body.D != nullptr) block += body.damping_scale * body.D->diagonal[i];
    v.col(i) += block.inverse() * plainDefect(body, i, v);
  }
  return v;
}

/// The sweep back does not compute the sums of the sweep forth again, yet knows what contacts have moved since.
TEST(MixedSweeps, TheSweepBackKnowsWhatContactsHaveMoved) {
  for (const bool damped : {false, true}) {
    PressedBlock scene(0.5, 0.03);
    BodySystem& body = scene.problem.bodies[0];
    body.b.setRandom();
    body.b *= 1e-4;
    for (int i = 0; i < body.K->rows(); ++i) {
      if (scene.fixed[i]) body.b.col(i).setZero();
    }
    if (damped) {
      body.D = body.K;
      body.damping_scale = 2e-3;
    }
    std::vector<int> moved;
    for (const ContactRow& row : scene.problem.contacts) {
      for (int a = 0; a < row.node_count; ++a) moved.push_back(row.nodes[a].node);
    }
    std::sort(moved.begin(), moved.end());
    moved.erase(std::unique(moved.begin(), moved.end()), moved.end());
    ASSERT_GT(moved.size(), 10u);
    const Vector3 by(0.01, -0.02, 0.03);
    const NodalVectors expected = plainPair(scene.problem, moved, by);
    const std::unique_ptr<Relaxation> relaxation = makeGaussSeidelRelaxation();
    ContactCorrector corrector;
    corrector.prepare(scene.problem.contacts.size(), nullptr);
    relaxation->prepare(scene.problem, scene.solution);
    relaxation->relax(scene.problem, 0, corrector, scene.solution);
    for (const int node : moved) scene.solution.v[0].col(node) += by;
    relaxation->relax(scene.problem, 1, corrector, scene.solution);
    EXPECT_LE((scene.solution.v[0] - expected).norm(), 1e-13 * expected.norm()) << (damped ? "damped" : "");
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
    const NodalVectors u = NodalVectors::Constant(3, asleep.mass.size(), 1e-3);
    same.solution.slow_changes = {u};
    one.solution.slow_changes = {u, u};
    const auto fixed_node = static_cast<int>(std::find(one.fixed.begin(), one.fixed.end(), true) - one.fixed.begin());
    for (ContactRow& row : one.problem.contacts) {
      for (int a = 0; a < row.node_count; ++a) row.nodes[a].body = 1;
      // A fixed node of a tissue asleep, which contact does not wake. Not where a sweep holds the contact's only node.
      if (row.node_count == 2 || row.node_count == 3) row.nodes[row.node_count++] = {0, fixed_node, -0.5};
    }
    const SolverReport report = used.solve(one.problem, one.solution);
    IterativePredictorCorrector(options(30, 20, 1e-12)).solve(same.problem, same.solution);
    EXPECT_GT(report.iterations, 10);
    EXPECT_EQ(one.solution.v[1], same.solution.v[0]) << contacts << " contacts";
    EXPECT_EQ(one.solution.v[0], NodalVectors::Zero(3, asleep.mass.size()));
    EXPECT_EQ(one.solution.slow_changes[1], same.solution.slow_changes[0]);
    EXPECT_EQ(one.solution.slow_changes[0], u);
    EXPECT_EQ(one.solution.impulses, same.solution.impulses);
  }
}

/// Adds a body with its contacts at the end of a problem.
void append(const PressedBlock& from, ContactProblem& problem, ContactSolution& solution) {
  const int body = static_cast<int>(problem.bodies.size());
  problem.dt_s = from.problem.dt_s;
  problem.bodies.push_back(from.problem.bodies[0]);
  solution.v.push_back(from.solution.v[0]);
  for (ContactRow row : from.problem.contacts) {
    for (int a = 0; a < row.node_count; ++a) row.nodes[a].body = body;
    problem.contacts.push_back(row);
  }
  solution.impulses.insert(solution.impulses.end(), from.solution.impulses.begin(), from.solution.impulses.end());
  solution.states.insert(solution.states.end(), from.solution.states.begin(), from.solution.states.end());
}

/// Two blocks that lack the same the opposite way: of those that something presses magnitudes are added.
TEST(Residuals, TheNetDefectIsThatOfEachBodyThatIsPressed) {
  PressedBlock one(0.5, 0.03);
  PressedBlock other(0.5, 0.03);
  ContactProblem problem;
  ContactSolution solution;
  for (PressedBlock* const block : {&one, &other}) {
    block->keepContacts(1);
    append(*block, problem, solution);
  }
  problem.bodies[0].b.row(0).setConstant(0.01);
  problem.bodies[1].b.row(0).setConstant(-0.01);
  const auto free = static_cast<double>(std::count(one.fixed.begin(), one.fixed.end(), false));
  std::vector<NodalVectors> scratch;
  EXPECT_EQ(computeResiduals(problem, solution, scratch).net_defect_n_s, 0.0);  // nothing is pressed
  const double tiny = 1e-9;
  solution.impulses[0].x() = tiny;
  EXPECT_NEAR(computeResiduals(problem, solution, scratch).net_defect_n_s, 0.01 * free, 2.0 * tiny);
  solution.impulses[1].x() = tiny;
  const Residuals both = computeResiduals(problem, solution, scratch);
  EXPECT_NEAR(both.net_defect_n_s, 0.02 * free, 4.0 * tiny);
  EXPECT_NEAR(both.momentum_defect_n_s, 0.01 * std::sqrt(2.0 * free), 4.0 * tiny);
  problem.bodies[1].asleep = true;
  EXPECT_NEAR(computeResiduals(problem, solution, scratch).net_defect_n_s, 0.01 * free, 2.0 * tiny);
}

/// What an old factor leaves, against b + J'lambda - A v; of a body on which contacts do not press nothing is added up.
TEST(CholeskyRelaxation, TellsWhatAllNodesLackTogether) {
  for (const double impulse : {1e-3, 0.0}) {
    PressedBlock scene(0.5, 0.03);
    scene.keepContacts(1);
    scene.problem.bodies[0].b.row(0).setConstant(0.01);
    scene.solution.impulses[0].x() = impulse;
    const std::unique_ptr<Relaxation> relaxation = makeCholeskyRelaxation();
    ContactCorrector corrector;
    corrector.prepare(1, nullptr);
    relaxation->prepare(scene.problem, scene.solution);
    scene.problem.bodies[0].stiffness_scale *= 1.2;
    relaxation->prepare(scene.problem, scene.solution);
    const MomentumDefect& left = relaxation->relax(scene.problem, 0, corrector, scene.solution);
    std::vector<NodalVectors> defect = {NodalVectors::Zero(3, scene.mesh.positions.cols())};
    addImpulse(scene.problem.contacts[0], scene.problem.contacts[0].R_WC * scene.solution.impulses[0], defect);
    const double squared = bodyDefect(scene.problem.bodies[0], scene.solution.v[0], defect[0], defect[0]);
    const double net = defect[0].rowwise().sum().norm();
    ASSERT_GT(net, 1e-3 * scene.problem.bodies[0].b.norm());
    EXPECT_NEAR(left.norm_n_s, std::sqrt(squared), 1e-12 * std::sqrt(squared));
    EXPECT_NEAR(left.net_n_s.at(0), impulse > 0.0 ? net : 0.0, 1e-12 * net);
  }
}

/// A contact between two bodies.
void join(int body, int other, ContactProblem& problem, ContactSolution& solution) {
  ContactRow row = problem.contacts[0];
  row.nodes[0].body = body;
  row.nodes[1].body = other;
  row.nodes[0].weight = 1.0;
  row.nodes[1].weight = -1.0;
  row.node_count = 2;
  problem.contacts.push_back(row);
  solution.impulses.emplace_back(Vector3::Zero());
  solution.states.push_back(ContactState::kOpen);
}

/// A body that no contact joins to others has weights of its own: it comes out as alone, to the last bit, and leaves no
/// trace in the others.
TEST(MixedSweeps, BodiesThatNothingJoinsAreMixedApart) {
  const PressedBlock soft(0.5, 0.03);
  const PressedBlock stiff(0.5, 0.2);  // a longer step on the same mesh: forty times the stiffness beside the mass
  const SolverOptions chosen = options(30, 2, 1e-15);
  ContactProblem two, three;
  ContactSolution of_two, of_three;
  append(soft, two, of_two);
  append(soft, two, of_two);
  join(0, 1, two, of_two);
  append(soft, three, of_three);
  append(soft, three, of_three);
  join(0, 1, three, of_three);
  append(stiff, three, of_three);
  ContactProblem one = stiff.problem;
  ContactSolution of_one = stiff.solution;
  EXPECT_EQ(IterativePredictorCorrector(chosen).solve(two, of_two).iterations, 30);
  EXPECT_EQ(IterativePredictorCorrector(chosen).solve(three, of_three).iterations, 30);
  EXPECT_EQ(IterativePredictorCorrector(chosen).solve(one, of_one).iterations, 30);
  EXPECT_EQ(of_three.v[0], of_two.v[0]);
  EXPECT_EQ(of_three.v[1], of_two.v[1]);
  EXPECT_EQ(of_three.v[2], of_one.v[0]);
  EXPECT_NE(of_two.v[0], of_two.v[1]);
}

TEST(MixedSweeps, RoundOffIsNotSolved) {
  BentBlock scene(1e-19);
  const SolverReport report = IterativePredictorCorrector(options(30, 20, 1e-4)).solve(scene.problem, scene.solution);
  EXPECT_EQ(report.stop, StopReason::kTolerance);
  EXPECT_EQ(report.iterations, 1);
  EXPECT_LT(residualsOf(scene).momentum, 1e-3);
}

}  // namespace mixed_sweeps_test
}  // namespace tissue_contact
