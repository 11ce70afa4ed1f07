/// Form E, the capstan: a strip that slides half round a cylinder pulls e^(mu pi) times as much on one side as on the
/// other. As a scene, a belt brake: a membrane fixed at both ends over a drum that turns. At the solver, a polygon of k
/// nodes that turns by D at each: [(1 + mu tan(D/2)) / (1 - mu tan(D/2))]^k exactly.
#include <algorithm>
#include <cmath>
#include <sstream>

#include "support/temporary_directory.h"
#include "support/text_scene.h"
#include "tissue_contact/baselines/make_contact_solver.h"
#include "validation/closed_forms.h"
#include "validation/report.h"

namespace tissue_contact {
namespace {

constexpr double kMu = 0.3;
const double kSmooth = std::exp(kMu * M_PI);  // 2.5663

// ---- the polygon
// -----------------------------------------------------------------------------------------------------

Vector3 alongBar(int bar, double turn) {
  const double angle = 0.5 * M_PI - bar * turn;  // up at first, down at last
  return {std::cos(angle), 0.0, std::sin(angle)};
}

/// Nodes 0 (fixed) to k + 1 in a chain of elastic bars; node k + 1 is pulled along the last bar by 1 N. In one long
/// step without inertia to speak of every node slides towards the pull, so friction is kinetic everywhere.
struct Chain {
  double tension_ratio;    ///< the pull over the tension of the first bar
  double unused_friction;  ///< worst share of its friction that a node does not use
};

Chain pullChain(int k, const SolverDescription& description) {
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
    K.add(K.pattern->find(i, i + 1), -stiffness);
  }
  ContactProblem problem;
  problem.dt_s = 1.0;
  BodySystem& body = problem.bodies.emplace_back();
  body.K = &K;
  body.fixed = &fixed;
  body.stiffness_scale = 1.0;
  // Without mass the hinged chain were a mechanism: sideways it has nothing else. This little moves the ratio by 1e-8; with
  // much less, rounding decides what it does sideways.
  body.mass = VectorX::Constant(k + 2, 4e-6 / (k * k));
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
  double unused = 0.0;
  for (const Vector3& impulse : solution.impulses) {
    const double share = std::abs(1.0 - impulse.tail<2>().norm() / (kMu * impulse[0]));
    if (!(share <= unused)) unused = share;  // NaN too
  }
  return {1.0 / (kBarStiffness * alongBar(0, turn).dot(Vector3(solution.v[0].col(1)))), unused};
}

double polygonRatio(int k) {
  const double friction = kMu * std::tan(0.5 * M_PI / k);
  return std::pow((1.0 + friction) / (1.0 - friction), k);
}

struct NamedSolver {
  const char* name;
  SolverDescription description;
  int most_nodes;
};

std::vector<NamedSolver> exactSolvers() {
  SolverDescription gauss_seidel;
  gauss_seidel.iterations = 10000;
  gauss_seidel.tolerance = 1e-12;
  SolverDescription cholesky = gauss_seidel;
  cholesky.relaxation = RelaxationKind::kCholesky;
  SolverDescription reference = gauss_seidel;
  reference.method = SolverMethod::kReference;
  // A pull travels one node per sweep or so and is spread like heat: 64 nodes would take ten thousands of sweeps.
  return {{"Gauss-Seidel", gauss_seidel, 16}, {"Cholesky", cholesky, 64}, {"reference", reference, 64}};
}

// The momentum of the nodes is 1e-8 of the pull, the solver stops at 1e-12.
void polygonIsExact(Report& report) {
  constexpr double kTolerance = 1e-7;
  report.near("polygon of 16: the formula itself", "", 2.5749, polygonRatio(16), 5e-5, "figure of the benchmark");
  ConvergenceStudy study = {"tension ratio of polygons", "", "turn per node (rad)", {}, kSmooth};
  for (const int k : {2, 4, 16, 64}) {
    for (const NamedSolver& solver : exactSolvers()) {
      if (k > solver.most_nodes) continue;
      const Chain chain = pullChain(k, solver.description);
      const std::string name = "polygon of " + std::to_string(k) + ", " + solver.name;
      report.near(name + ": tension ratio", "", polygonRatio(k), chain.tension_ratio, kTolerance * polygonRatio(k),
                  "[(1 + mu tan(D/2)) / (1 - mu tan(D/2))]^k");
      report.atMost(name + ": friction not used", "", kTolerance, chain.unused_friction, "every node slides");
    }
    if (k > 2) study.levels.push_back({M_PI / k, pullChain(k, exactSolvers()[1].description).tension_ratio});
  }
  // tan(D/2) = D/2 (1 + D^2 / 12 + ...): with the quarter turns of k = 4 the next order is 5 % of the first.
  report.near("polygons: observed order in the turn", "", 2.0, study.observedOrder(), 0.05, "tan(D/2) - D/2");
  report.convergence(study);
}

// ---- the belt
// --------------------------------------------------------------------------------------------------------

constexpr double kDrumRadius = 0.02;
constexpr double kThickness = 0.001;
constexpr double kWidth = 0.01;
constexpr double kLeg = 0.02;  // straight on either side, m
constexpr int kLegCells = 5;

/// The strip's middle line about the drum: straight legs and a polygon of `facets` that touches the drum with the
/// middle of each facet, so that it lies on it without being stretched. Two nodes per row.
std::string beltObj(int facets) {
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
  std::ostringstream obj;
  obj.precision(17);
  for (const Vector2& p : line) {
    obj << "v " << p.x() << " " << -0.5 * kWidth << " " << p.y() << "\n";
    obj << "v " << p.x() << " " << 0.5 * kWidth << " " << p.y() << "\n";
  }
  for (std::size_t i = 0; i + 1 < line.size(); ++i) {
    const std::size_t a = 2 * i + 1;  // OBJ counts from 1
    obj << "f " << a << " " << a + 1 << " " << a + 3 << "\nf " << a << " " << a + 3 << " " << a + 2 << "\n";
  }
  return obj.str();
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
  const TemporaryDirectory directory;
  std::ostringstream yaml;
  yaml << "tissues:\n  - name: belt\n    shell: {file: \"" << directory.write("belt.obj", beltObj(facets))
       << "\", thickness_m: " << kThickness
       << "}\n    material: {youngs_modulus_pa: 1.0e6, poissons_ratio: 0, density_kg_per_m3: 3.0e4,"
       << " bending_stiffness_n_m: 0}\n    damping: {stiffness_s: 0.002}\n"
       << "    fixed: [{plane: {point_m: [0, 0, " << 1e-6 - kLeg << "], normal: [0, 0, 1]}}]\n"
       << "instruments:\n  - {name: drum, robot_description: drum, tip_link: lift, contact_links: [drum],"
       << " joint_state_topics: [/drum]}\n"
       << "friction:\n  - {instrument: drum, tissue: belt, static: " << kMu << "}\n"
       << "solver: {iterations: 300, tolerance: 1.0e-6}\n";
  return makeSimulator(yaml.str(), {{"drum", drumUrdf()}});
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

/// Lifts the drum by 1 mm, which tightens the strip, and turns it until it slides evenly: from right to left over the
/// top.
Simulator brake(int facets) {
  Simulator simulator = makeBrake(facets);
  for (int k = 1; k <= 200; ++k) simulator.advance(0.001, {Vector2(0.001 * k / 200, 0.0)});
  for (int k = 1; k <= 500; ++k) simulator.advance(0.001, {Vector2(0.001, -5e-4 * k)});
  return simulator;
}

void beltOnATurningDrum(Report& report) {
  ConvergenceStudy study = {"tension ratio of the belt", "", "turn per facet (rad)", {}, kSmooth};
  double done = 0.0;
  for (const int facets : {8, 16, 32}) {
    Simulator simulator = brake(facets);
    const Vector2 ends = endForces(simulator);
    const double ratio = ends.maxCoeff() / ends.minCoeff();
    const std::string name = "belt of " + std::to_string(facets) + " facets: ";
    if (facets > 8) report.near(name + "tension ratio", "", kSmooth, ratio, 0.02 * kSmooth, "e^(mu phi)");
    report.near(name + "force on the drum", "N", ends.sum(), -simulator.wrench(0).force.z(), 1e-3 * ends.sum(),
                "what the belt's two ends pull");
    study.levels.push_back({M_PI / facets, ratio});
    report.progress(done += 1.0 / 3.0);
  }
  // A polygon's friction is second order, but where the belt first touches is known to a facet only.
  report.atLeast("belt: observed order in the turn", "", 1.0, study.observedOrder(), "first order at least");
  report.convergence(study);
}

}  // namespace

void validateCapstan(Report& report) {
  polygonIsExact(report);
  beltOnATurningDrum(report);
}

}  // namespace tissue_contact
