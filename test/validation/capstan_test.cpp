/// Form E, the capstan: a strip that slides half round a cylinder pulls e^(mu pi) times as much on one side as on the
/// other. As a scene, a belt brake: a membrane fixed at both ends over a drum that turns. At the solver, a polygon of k nodes
/// that turns by D at each: [(1 + mu tan(D/2)) / (1 - mu tan(D/2))]^k exactly.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdio>
#include <fstream>
#include <iostream>

#include "validation/text_scene.h"

namespace tissue_contact {
namespace {

constexpr double kMu = 0.3;

// ---- the polygon -----------------------------------------------------------------------------------------------------

Vector3 alongBar(int bar, double turn) {
  const double angle = 0.5 * M_PI - bar * turn;  // up at first, down at last
  return {std::cos(angle), 0.0, std::sin(angle)};
}

/// Nodes 0 (fixed) to k + 1 in a chain of elastic bars; node k + 1 is pulled along the last bar by 1 N. In one long step
/// without inertia to speak of every node slides towards the pull, so friction is kinetic everywhere.
/// @return the pull over the tension of the first bar.
double tensionRatio(int k, const SolverDescription& description) {
  constexpr double kBarStiffness = 1000.0;  // N/m
  const double turn = M_PI / k;
  std::vector<bool> fixed(k + 2, false);
  fixed[0] = true;
  std::vector<std::array<int, 2>> bars;
  for (int i = 0; i <= k; ++i) bars.push_back({i, i + 1});
  BlockMatrix K = BlockMatrix::forElements(bars, fixed);
  for (int i = 0; i <= k; ++i) {
    const Matrix3 stiffness = kBarStiffness * alongBar(i, turn) * alongBar(i, turn).transpose();
    K.diagonal[i] += stiffness;
    K.diagonal[i + 1] += stiffness;
    if (i == 0) continue;
    K.values[K.find(i, i + 1)] = -stiffness;
    K.values[K.find(i + 1, i)] = -stiffness;
  }
  ContactProblem problem;
  problem.dt_s = 1.0;
  BodySystem& body = problem.bodies.emplace_back();
  body.K = &K;
  body.fixed = &fixed;
  body.stiffness_scale = 1.0;
  body.mass = VectorX::Constant(k + 2, 1e-9);
  body.b = NodalVectors::Zero(3, k + 2);
  body.b.col(k + 1) = alongBar(k, turn);
  for (int i = 1; i <= k; ++i) {
    ContactRow& row = problem.contacts.emplace_back();
    row.nodes[0] = {0, i, 1.0};
    row.node_count = 1;
    const Vector3 tangent = (alongBar(i - 1, turn) + alongBar(i, turn)).normalized();
    const Vector3 outward = (alongBar(i - 1, turn) - alongBar(i, turn)).normalized();
    row.R_WC << outward, tangent, outward.cross(tangent);
    row.law = {kMu, kMu};
  }
  ContactSolution solution;
  solution.v.emplace_back(NodalVectors::Zero(3, k + 2));
  solution.impulses.assign(k, Vector3::Zero());
  solution.states.assign(k, ContactState::kOpen);
  makeContactSolver(description)->solve(problem, solution);
  // Every node uses its whole friction; at that limit rounding decides whether it is called static or kinetic.
  for (const Vector3& impulse : solution.impulses) {
    EXPECT_NEAR(impulse.tail<2>().norm(), kMu * impulse[0], 1e-7 * impulse[0]);
  }
  return 1.0 / (kBarStiffness * alongBar(0, turn).dot(Vector3(solution.v[0].col(1))));
}

double polygonRatio(int k) {
  const double friction = kMu * std::tan(0.5 * M_PI / k);
  return std::pow((1.0 + friction) / (1.0 - friction), k);
}

// The momentum of the nodes is 1e-9 of the pull, the solver stops at 1e-12.
TEST(Capstan, PolygonIsExact) {
  ASSERT_NEAR(polygonRatio(16), 2.5749, 5e-5);
  SolverDescription gauss_seidel;
  gauss_seidel.iterations = 10000;
  gauss_seidel.tolerance = 1e-12;
  SolverDescription cholesky = gauss_seidel;
  cholesky.relaxation = RelaxationKind::kCholesky;
  SolverDescription reference = gauss_seidel;
  reference.method = SolverMethod::kReference;
  for (const int k : {2, 4, 16, 64}) {
    for (const SolverDescription& description : {gauss_seidel, cholesky, reference}) {
      // A pull travels one node per sweep or so and is spread like heat: 64 nodes would take ten thousands of them.
      if (k > 16 && description.method != SolverMethod::kReference &&
          description.relaxation == RelaxationKind::kGaussSeidel) {
        continue;
      }
      const double ratio = tensionRatio(k, description);
      EXPECT_NEAR(ratio, polygonRatio(k), 1e-7 * polygonRatio(k))
          << k << " nodes, " << solverMethodName(description.method) << ", " << relaxationName(description.relaxation);
    }
    std::cout << k << " nodes: " << tensionRatio(k, cholesky) << " (" << polygonRatio(k) << ")\n";
  }
}

// ---- the belt --------------------------------------------------------------------------------------------------------

constexpr double kDrumRadius = 0.02;
constexpr double kThickness = 0.001;
constexpr double kWidth = 0.01;
constexpr double kLeg = 0.02;  // straight on either side, m
constexpr int kLegCells = 5;

/// The strip's middle line about the drum: straight legs and a polygon of `facets` that touches the drum with the middle
/// of each facet, so that it lies on it without being stretched. Two nodes per row.
std::string writeBelt(int facets) {
  const double radius = kDrumRadius + 0.5 * kThickness;
  const double turn = M_PI / facets;
  std::vector<Vector2> line;  // x, z
  line.reserve(facets + 2 * kLegCells);
  for (int i = 0; i < kLegCells; ++i) line.emplace_back(radius, -kLeg * (kLegCells - i) / kLegCells);
  for (int i = 0; i < facets; ++i) {
    const double angle = (i + 0.5) * turn;
    line.emplace_back(radius / std::cos(0.5 * turn) * Vector2(std::cos(angle), std::sin(angle)));
  }
  for (int i = 1; i <= kLegCells; ++i) line.emplace_back(-radius, -kLeg * i / kLegCells);
  std::string file = testing::TempDir() + "capstan_belt_" + std::to_string(facets) + ".obj";
  std::ofstream obj(file);
  obj.precision(17);
  for (const Vector2& p : line) {
    obj << "v " << p.x() << " " << -0.5 * kWidth << " " << p.y() << "\n";
    obj << "v " << p.x() << " " << 0.5 * kWidth << " " << p.y() << "\n";
  }
  for (std::size_t i = 0; i + 1 < line.size(); ++i) {
    const std::size_t a = 2 * i + 1;  // OBJ counts from 1
    obj << "f " << a << " " << a + 1 << " " << a + 3 << "\nf " << a << " " << a + 3 << " " << a + 2 << "\n";
  }
  return file;
}

/// The drum on a lift (z) and an axle (y).
std::string drumUrdf() {
  const auto joint = [](const std::string& name, const std::string& type, const std::string& parent,
                        const std::string& child, const std::string& axis) {
    return "<joint name='" + name + "' type='" + type + "'><parent link='" + parent + "'/><child link='" + child +
           "'/><axis xyz='" + axis + "'/><limit lower='-9' upper='9' effort='1' velocity='1'/></joint>";
  };
  return "<robot name='drum'><link name='base'/><link name='lift'/>" +
         joint("lift", "prismatic", "base", "lift", "0 0 1") + joint("axle", "revolute", "lift", "drum", "0 1 0") +
         "<link name='drum'><collision><origin xyz='0 0 0' rpy='1.5707963267948966 0 0'/><geometry><cylinder radius='" +
         std::to_string(kDrumRadius) + "' length='0.05'/></geometry></collision></link></robot>";
}

Simulator makeBrake(int facets) {
  const std::string file = writeBelt(facets);
  std::ostringstream yaml;
  yaml << "tissues:\n  - name: belt\n    shell: {file: \"" << file << "\", thickness_m: " << kThickness
       << "}\n    material: {youngs_modulus_pa: 1.0e6, poissons_ratio: 0, density_kg_per_m3: 3.0e4,"
       << " bending_stiffness_n_m: 0}\n    damping: {stiffness_s: 0.002}\n"
       << "    fixed: [{plane: {point_m: [0, 0, " << 1e-6 - kLeg << "], normal: [0, 0, 1]}}]\n"
       << "instruments:\n  - {name: drum, robot_description: drum, tip_link: lift, contact_links: [drum],"
       << " joint_state_topics: [/drum]}\n"
       << "friction:\n  - {instrument: drum, tissue: belt, static: " << kMu << "}\n"
       << "solver: {iterations: 300, tolerance: 1.0e-6}\n";
  Simulator simulator = makeSimulator(yaml.str(), {{"drum", drumUrdf()}});
  std::remove(file.c_str());
  return simulator;
}

/// What the strip pulls at its two fixed ends, N: left (x < 0), right.
Vector2 endForces(const Simulator& simulator) {
  const Tissue& belt = simulator.tissues()[0];
  const auto state = belt.elasticity().makeState();
  NodalVectors forces(3, belt.nodeCount());
  belt.elasticity().update(simulator.positions(0), *state, forces);
  Vector3 left = Vector3::Zero();
  Vector3 right = Vector3::Zero();
  for (int i = 0; i < belt.nodeCount(); ++i) {
    if (belt.fixed()[i]) (belt.restPositions()(0, i) < 0.0 ? left : right) += forces.col(i);
  }
  return {left.norm(), right.norm()};
}

/// Lifts the drum by 1 mm, which tightens the strip, and turns it until it slides evenly: from right to left over the top.
Simulator brake(int facets) {
  Simulator simulator = makeBrake(facets);
  for (int k = 1; k <= 200; ++k) simulator.advance(0.001, {Vector2(0.001 * k / 200, 0.0)});
  for (int k = 1; k <= 500; ++k) simulator.advance(0.001, {Vector2(0.001, -5e-4 * k)});
  return simulator;
}

TEST(Capstan, BeltOnATurningDrum) {
  const double smooth = std::exp(kMu * M_PI);
  for (const int facets : {16, 32}) {
    Simulator simulator = brake(facets);
    const Vector2 ends = endForces(simulator);
    const double ratio = ends.maxCoeff() / ends.minCoeff();
    const Wrench wrench = simulator.wrench(0);
    std::cout << facets << " facets: " << ends.transpose() << " N, ratio " << ratio << " (smooth " << smooth
              << ", polygon " << polygonRatio(facets) << "); on the drum " << wrench.force.transpose() << " N, "
              << wrench.torque.transpose() << " N m; " << simulator.report().kinetic_contacts << " sliding, "
              << simulator.report().static_contacts << " held\n";
    EXPECT_NEAR(ratio, smooth, 0.02 * smooth);
    EXPECT_NEAR(-wrench.force.z(), ends.sum(), 1e-3 * ends.sum());
  }
}

}  // namespace
}  // namespace tissue_contact
