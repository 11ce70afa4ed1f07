/// Form A: one contact whose answer is known in closed form, in round-off: stick, slip, the threshold between them,
/// both sides of hysteresis, and the strong friction for which open, slip and stick are all exact. As the contact
/// problem of a step (one node, or two that share the contact, normals in several directions) and as a Delassus
/// problem.
#include <algorithm>
#include <limits>
#include <optional>

#include "tissue_contact/baselines/delassus.h"
#include "tissue_contact/baselines/make_contact_solver.h"
#include "validation/closed_forms.h"
#include "validation/report.h"

namespace tissue_contact {
namespace {

/// u = W r + q in the contact frame (n, t1, t2), and its answer.
struct OneContact {
  const char* name;
  Matrix3 W;
  Vector3 q;
  CoulombLaw law;
  bool was_sliding;
  Vector3 r;
  Vector3 u;
  std::optional<ContactState> state;  ///< none: both are right
};

struct Answer {
  Vector3 r = Vector3::Zero();
  Vector3 u = Vector3::Zero();
  ContactState state = ContactState::kOpen;
};

// By hand: r = -q / W where that lies in the static cone (not, if the contact slid before: in the kinetic one); else
// u_n = 0 leaves r_n = 2, |r_t| = mu_k r_n against the slip.
std::vector<OneContact> problems() {
  const Matrix3 W = 0.5 * Matrix3::Identity();
  const CoulombLaw one = {0.5, 0.5};
  const CoulombLaw two = {0.5, 0.3};
  const Vector3 still = Vector3::Zero();
  return {
      {"stick", W, {-1.0, 0.2, 0.1}, one, false, {2.0, -0.4, -0.2}, still, ContactState::kStatic},
      {"slip", W, {-1.0, 1.2, 1.6}, one, false, {2.0, -0.6, -0.8}, {0.0, 0.9, 1.2}, ContactState::kKinetic},
      {"open", W, {1.0, 0.2, 0.1}, one, false, still, {1.0, 0.2, 0.1}, ContactState::kOpen},
      {"at the threshold", W, {-1.0, 0.3, 0.4}, one, false, {2.0, -0.6, -0.8}, still, std::nullopt},
      {"mu .5/.3, held before", W, {-1.0, 0.4, 0.0}, two, false, {2.0, -0.8, 0.0}, still, ContactState::kStatic},
      {"mu .5/.3, slid before", W, {-1.0, 0.4, 0.0}, two, true, {2.0, -0.6, 0.0}, {0, 0.1, 0}, ContactState::kKinetic},
      {"mu .5/.3, torn off", W, {-1.0, 0.6, 0.0}, two, false, {2.0, -0.6, 0.0}, {0, 0.3, 0}, ContactState::kKinetic},
  };
}

SolverDescription describe(SolverMethod method, RelaxationKind relaxation) {
  SolverDescription description;
  description.method = method;
  description.relaxation = relaxation;
  description.iterations = 100;
  description.tolerance = 1e-15;
  return description;
}

/// The problem as a step's: `nodes` equal nodes share the contact, A = R W^-1 R' / nodes for each, so that J A^-1 J' =
/// W and the free velocity is q.
Answer solveStep(const OneContact& one, const Matrix3& R_WC, int nodes, const SolverDescription& description,
                 const Answer& start = {}) {
  const Matrix3 A = R_WC * one.W.inverse() * R_WC.transpose() / nodes;
  constexpr double kMass = 0.01;  // less than any eigenvalue of A, so that K is positive definite
  const std::vector<bool> fixed(nodes, false);
  BlockMatrix K = BlockMatrix::forTetrahedra({}, fixed);
  ContactProblem problem;
  problem.dt_s = 1.0;
  BodySystem& body = problem.bodies.emplace_back();
  body.K = &K;
  body.fixed = &fixed;
  body.stiffness_scale = 1.0;
  body.mass = VectorX::Constant(nodes, kMass);
  body.b.resize(3, nodes);
  ContactRow& row = problem.contacts.emplace_back();
  row.R_WC = R_WC;
  row.node_count = nodes;
  row.law = one.law;
  row.was_sliding = one.was_sliding;
  for (int i = 0; i < nodes; ++i) {
    K.diagonal[i] = A - kMass * Matrix3::Identity();
    body.b.col(i) = A * R_WC * one.q;
    row.nodes[i] = {0, i, 1.0 / nodes};
  }
  ContactSolution solution;
  solution.v.emplace_back((R_WC * start.u).replicate(1, nodes));
  solution.impulses = {start.r};
  solution.states = {start.state};
  makeContactSolver(description)->solve(problem, solution);
  return {solution.impulses[0], relativeVelocity(row, solution.v), solution.states[0]};
}

Answer solveDelassusOf(const OneContact& one, SolverMethod method, const Answer& start = {}) {
  DelassusProblem problem;
  problem.W = one.W;
  problem.q = one.q;
  problem.laws = {one.law};
  problem.was_sliding = {one.was_sliding};
  DelassusSolution solution;
  solution.r = start.r;
  solution.u = start.u;
  solution.states = {start.state};
  solveDelassus(problem, describe(method, RelaxationKind::kGaussSeidel), solution);
  return {solution.r, solution.u, solution.states[0]};
}

/// Every way to solve the problem with `method`.
std::vector<Answer> solveAll(const OneContact& one, SolverMethod method, const Answer& start = {}) {
  std::vector<Matrix3> frames = {Matrix3::Identity()};
  for (const double sign : {1.0, -1.0}) {  // n along (1, 1, 1) / sqrt 3 and against it
    frames.push_back(Quaternion::FromTwoVectors(Vector3::UnitX(), sign * Vector3::Ones()).toRotationMatrix());
  }
  std::vector<Answer> answers = {solveDelassusOf(one, method, start)};
  for (const Matrix3& R_WC : frames) {
    for (const int nodes : {1, 2}) {
      for (const RelaxationKind relaxation : {RelaxationKind::kGaussSeidel, RelaxationKind::kCholesky}) {
        answers.push_back(solveStep(one, R_WC, nodes, describe(method, relaxation), start));
      }
    }
  }
  return answers;
}

constexpr std::pair<SolverMethod, const char*> kSolvers[] = {{SolverMethod::kPredictorCorrector, "predictor-corrector"},
                                                             {SolverMethod::kReference, "reference"}};

/// The larger one, or NaN if either is.
double worse(double a, double b) { return b <= a ? a : b; }

void closedForms(Report& report) {
  for (const OneContact& one : problems()) {
    for (const auto& [method, method_name] : kSolvers) {
      double worst_r = 0.0;
      double worst_u = 0.0;
      bool right = true;
      for (const Answer& answer : solveAll(one, method)) {
        worst_r = worse(worst_r, (answer.r - one.r).norm());
        worst_u = worse(worst_u, (answer.u - one.u).norm());
        right = right && (!one.state || answer.state == *one.state);
      }
      const std::string name = std::string(one.name) + ", " + method_name;
      // Some 50 units in the last place of r: products with R, A and its factor.
      report.atMost(name + ": error of r", "N s", 1e-14, worst_r, "r = -q / W, cut to the cone");
      report.atMost(name + ": error of u", "m/s", 1e-14, worst_u, "u = W r + q");
      if (one.state) report.require(name + ": state", right, "static iff |r_t| <= mu r_n with u = 0");
    }
  }
}

// W_nt = .8 and mu = 1.5: more friction pushes the contact apart, W_nn - mu W_nt < 0. With q = (.1, .5, 0):
//   open:  r = 0;   slip:  .1 + r_n (1 - 1.2) = 0: r = (.5, -.75, 0), u_t = .15;   stick:  r = -W^-1 q, |r_t| = 1.4
// r_n.
void threeSolutions(Report& report) {
  OneContact one = {"", Matrix3::Identity(), {0.1, 0.5, 0.0}, {1.5, 1.5}, false, {}, {}, std::nullopt};
  one.W(0, 1) = one.W(1, 0) = 0.8;
  const Answer exact[] = {
      {Vector3::Zero(), one.q, ContactState::kOpen},
      {{0.5, -0.75, 0.0}, {0.0, 0.15, 0.0}, ContactState::kKinetic},
      {-one.W.inverse() * one.q, Vector3::Zero(), ContactState::kStatic},
  };
  int found[] = {0, 0, 0};
  for (const auto& [method, method_name] : kSolvers) {
    double worst = 0.0;
    for (const Answer& start : exact) {
      for (const Answer& answer : solveAll(one, method, start)) {
        double nearest = std::numeric_limits<double>::infinity();
        int which = 0;
        for (int i = 0; i < 3; ++i) {
          const double distance = (answer.r - exact[i].r).norm() + (answer.u - exact[i].u).norm();
          if (distance < nearest) which = i;
          nearest = std::min(nearest, distance);
        }
        worst = worse(worst, nearest);
        ++found[which];
      }
    }
    // W and A amplify round-off by their condition, 9, each.
    report.atMost(std::string("mu 1.5, off the nearest answer: ") + method_name, "", 1e-12, worst,
                  "open, slip and stick are exact: any will do");
  }
  report.note("mu 1.5, started at each answer: found open " + std::to_string(found[0]) + ", slip " +
              std::to_string(found[1]) + ", stick " + std::to_string(found[2]) + " times");
}

}  // namespace

void validateOneContact(Report& report) {
  closedForms(report);
  threeSolutions(report);
}

}  // namespace tissue_contact
