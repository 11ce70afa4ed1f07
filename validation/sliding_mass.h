/// @file
/// Room `validation`: one mass on a spring along x, pressed on a moving belt by its weight: the contact problem of a single
/// node given to the solver, with friction's history handed on as the simulator does.
#pragma once

#include "tissue_contact/baselines/make_contact_solver.h"

namespace tissue_contact {

/// Stepped by the implicit midpoint rule, which neither damps nor drives an oscillation:
///   v = (v0 + v1) / 2,  (2 m + dt^2/2 k) v = 2 m v0 + dt (m g - k x0) + impulse,  x1 = x0 + dt v,  v1 = 2 v - v0,
/// with the friction law on v. A held mass has the belt's velocity at the end of the step too.
/// Or as the simulator steps, by implicit Euler:
///   (m + dt^2 k) v1 = m v0 + dt (m g - k x0) + impulse,  x1 = x0 + dt v1.
class SlidingMass {
 public:
  enum class Rule { kMidpoint, kImplicitEuler };

  SlidingMass(double mass_kg, double stiffness_n_per_m, double gravity_m_per_s2, const CoulombLaw& law, double x_m,
              Rule rule = Rule::kMidpoint)
      : mass_(mass_kg),
        gravity_(gravity_m_per_s2),
        rule_(rule),
        x_(x_m, 0.0, 0.0),
        solver_(makeContactSolver(exact())) {
    K_ = BlockMatrix::forTetrahedra({}, fixed_);
    K_.diagonal[0](0, 0) = stiffness_n_per_m;
    BodySystem& body = problem_.bodies.emplace_back();
    body.K = &K_;
    body.fixed = &fixed_;
    body.b.resize(3, 1);
    ContactRow& row = problem_.contacts.emplace_back();
    row.nodes[0] = {0, 0, 1.0};
    row.node_count = 1;
    row.R_WC << 0, 1, 0, 0, 0, 1, 1, 0, 0;  // normal: up
    row.law = law;
    solution_.v.emplace_back(NodalVectors::Zero(3, 1));
    solution_.impulses.emplace_back(Vector3::Zero());
    solution_.states.push_back(ContactState::kOpen);
  }
  SlidingMass(const SlidingMass&) = delete;
  SlidingMass& operator=(const SlidingMass&) = delete;

  /// @param belt_speed along x, m/s.
  void step(double dt, double belt_speed) {
    BodySystem& body = problem_.bodies[0];
    const bool midpoint = rule_ == Rule::kMidpoint;
    const double mass = midpoint ? 2.0 * mass_ : mass_;
    problem_.dt_s = dt;
    body.mass = VectorX::Constant(1, mass);
    body.stiffness_scale = (midpoint ? 0.5 : 1.0) * dt * dt;
    body.b.col(0) = mass * velocity_ - dt * (K_.diagonal[0] * x_);
    body.b(2, 0) -= dt * mass_ * gravity_;
    ContactRow& row = problem_.contacts[0];
    row.u_tool = Vector3(0.0, belt_speed, 0.0);
    row.was_sliding = state() == ContactState::kKinetic;
    solver_->solve(problem_, solution_);
    const Vector3 v = solution_.v[0].col(0);
    x_ += dt * v;
    velocity_ = !midpoint || state() == ContactState::kStatic ? v : Vector3(2.0 * v - velocity_);
    velocity_.z() = 0.0;
  }

  double position() const { return x_.x(); }
  ContactState state() const { return solution_.states[0]; }

 private:
  static SolverDescription exact() {
    SolverDescription description;
    description.iterations = 100;
    description.tolerance = 1e-13;
    return description;
  }

  double mass_;
  double gravity_;
  Rule rule_;
  Vector3 x_;
  Vector3 velocity_ = Vector3::Zero();
  std::vector<bool> fixed_ = {false};
  BlockMatrix K_;
  ContactProblem problem_;
  ContactSolution solution_;
  std::unique_ptr<ContactSolver> solver_;
};

}  // namespace tissue_contact
