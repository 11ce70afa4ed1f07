/// @file
/// A pressed block and solver options, for tests of the step's solvers.
#pragma once

#include <memory>
#include <random>
#include <vector>

#include "tissue_contact/mesh/tet_mesh.h"
#include "tissue_contact/solver/contact_problem.h"
#include "tissue_contact/solver/residuals.h"
#include "tissue_contact/solver/solver_options.h"
#include "tissue_contact/tissue/tet_elasticity.h"

namespace tissue_contact {

inline SolverOptions options(int iterations, int contact_passes, double tolerance,
                             RelaxationKind relaxation = RelaxationKind::kGaussSeidel) {
  SolverOptions chosen;
  chosen.relaxation = relaxation;
  chosen.iterations = iterations;
  chosen.contact_passes = contact_passes;
  chosen.tolerance = tolerance;
  return chosen;
}

/// @param scene has a `problem` and its `solution`.
template <typename Scene>
Residuals residualsOf(const Scene& scene) {
  std::vector<NodalVectors> scratch;
  return computeResiduals(scene.problem, scene.solution, scratch);
}

/// A block pressed and sheared through barycentric contacts on its upper face.
struct PressedBlock {
  TetMesh mesh;
  std::vector<bool> fixed;
  std::unique_ptr<Elasticity::State> state;
  ContactProblem problem;
  ContactSolution solution;

  void keepContacts(std::size_t count) {
    problem.contacts.resize(count);
    solution.impulses.resize(count);
    solution.states.resize(count);
  }

  PressedBlock(double mu, double dt) {
    mesh = makeBlockMesh({Vector3(0.04, 0.04, 0.02), {4, 4, 2}, {}});
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

}  // namespace tissue_contact
