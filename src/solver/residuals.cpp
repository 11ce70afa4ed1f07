#include "tissue_contact/solver/residuals.h"

#include <cmath>

#include "solver/sparse_system.h"
#include "tissue_contact/friction/friction_law.h"

namespace tissue_contact {
namespace {

/// std::max would drop a NaN: a worst value that is not a number must stay visible.
void worsen(double& worst, double value) {
  if (!(value <= worst)) worst = value;
}

/// What weight gives the nodes of all bodies that are awake in one step, N s. While tissue creeps back to rest, |b| falls
/// to the errors of the steps before: over it alone, an unbalanced force of a hundred-millionth of a newton reads like
/// failure.
double weightImpulse(const ContactProblem& problem) {
  constexpr double kGravity = 9.81;  // m/s^2: a measure, whatever the scene's gravity is
  double mass = 0.0;
  for (const BodySystem& body : problem.bodies) {
    if (!body.asleep) mass += body.mass.squaredNorm();
  }
  return kGravity * problem.dt_s * std::sqrt(mass);
}

/// Over all bodies.
void momentumResidual(const ContactProblem& problem, const ContactSolution& solution,
                      std::vector<NodalVectors>& contact_impulses, Residuals& residuals) {
  for (std::size_t k = 0; k < problem.bodies.size(); ++k) {
    if (!problem.bodies[k].asleep) contact_impulses[k].setZero();
  }
  for (std::size_t c = 0; c < problem.contacts.size(); ++c) {
    const ContactRow& row = problem.contacts[c];
    const Vector3 impulse = row.R_WC * solution.impulses[c];
    for (int a = 0; a < row.node_count; ++a) {
      const RowNode& at = row.nodes[a];
      if (!(*problem.bodies[at.body].fixed)[at.node]) contact_impulses[at.body].col(at.node) += at.weight * impulse;
    }
  }
  double defect = 0.0;
  double pressed = 0.0;
  for (std::size_t k = 0; k < problem.bodies.size(); ++k) {
    if (problem.bodies[k].asleep) continue;
    pressed += contact_impulses[k].squaredNorm();
    defect += bodyDefect(problem.bodies[k], solution.v[k], contact_impulses[k], contact_impulses[k]);
  }
  residuals.momentum_defect_n_s = std::sqrt(defect);
  if (defect == 0.0) return;
  const double scale = pressed == 0.0 ? loadScale(problem) + weightImpulse(problem) : std::sqrt(pressed);
  residuals.momentum = residuals.momentum_defect_n_s / scale;
}

/// How far friction is beyond what the contact's law allows, N; negative inside.
double coneViolation(const ContactRow& row, ContactState state, const Vector3& force) {
  const bool kinetic = state != ContactState::kStatic || row.was_sliding;
  const Vector2 friction = force.tail<2>();
  if (row.law.anisotropic == nullptr) {
    return friction.norm() - (kinetic ? row.law.mu_kinetic : row.law.mu_static) * force[0];
  }
  if (friction.isZero(0.0)) return 0.0;
  return friction.norm() * (1.0 - force[0] / frictionUse(row.law, friction, kinetic));
}

/// Angle between the friction force and the one its law asks for at this sliding, rad.
double kineticAngle(const CoulombLaw& law, const Vector2& friction, const Vector2& sliding) {
  const Vector2 asked = law.anisotropic == nullptr ? Vector2(-sliding) : kineticFriction(law, sliding.normalized());
  return std::abs(std::atan2(friction.x() * asked.y() - friction.y() * asked.x(), friction.dot(asked)));
}

}  // namespace

double loadScale(const ContactProblem& problem) {
  constexpr double kStill = 1e-9;  // m/s
  double load = 0.0;
  double mass = 0.0;
  for (const BodySystem& body : problem.bodies) {
    if (body.asleep) continue;
    load += body.b.squaredNorm();
    mass += body.mass.squaredNorm();
  }
  return std::sqrt(load) + kStill * std::sqrt(mass);
}

Residuals computeResiduals(const ContactProblem& problem, const ContactSolution& solution,
                           std::vector<NodalVectors>& scratch) {
  Residuals worst;
  const double dt = problem.dt_s;
  for (std::size_t c = 0; c < problem.contacts.size(); ++c) {
    const ContactRow& row = problem.contacts[c];
    const Vector3 u = relativeVelocity(row, solution.v);
    const Vector3 force = solution.impulses[c] / dt;
    const ContactState state = solution.states[c];
    worsen(worst.penetration_m, -(row.gap_m + dt * u[0]));
    worsen(worst.adhesion_n, -force[0]);
    worsen(worst.complementarity_w, std::abs(force[0] * (u[0] - row.required_u_n)));
    if (state == ContactState::kOpen) continue;
    const Vector2 friction = force.tail<2>();
    const Vector2 sliding = u.tail<2>();
    worsen(worst.cone_violation_n, coneViolation(row, state, force));
    if (state == ContactState::kStatic) {
      worsen(worst.static_slip_m_per_s, sliding.norm());
    } else if (friction.norm() > 0.0 && sliding.norm() > 0.0) {
      worsen(worst.kinetic_angle_rad, kineticAngle(row.law, friction, sliding));
    }
  }
  momentumResidual(problem, solution, scratch, worst);
  return worst;
}

}  // namespace tissue_contact
