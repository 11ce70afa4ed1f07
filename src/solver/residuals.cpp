#include "tissue_contact/solver/residuals.h"

#include <array>
#include <cmath>

#include "core/slice_product.h"
#include "solver/momentum_defect.h"
#include "solver/residual_measures.h"

namespace tissue_contact {
namespace {

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
  contact_impulses.resize(problem.bodies.size());
  for (std::size_t k = 0; k < problem.bodies.size(); ++k) {
    contact_impulses[k].resize(3, problem.bodies[k].K->rows());
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
    const double pressed_here = contact_impulses[k].squaredNorm();
    pressed += pressed_here;
    defect += bodyDefect(problem.bodies[k], solution.v[k], contact_impulses[k], contact_impulses[k]);
    if (pressed_here > 0.0) residuals.net_defect_n_s += contact_impulses[k].rowwise().sum().norm();
  }
  residuals.momentum_defect_n_s = std::sqrt(defect);
  if (defect == 0.0) return;
  const double scale = pressed == 0.0 ? loadScale(problem) + weightImpulse(problem) : std::sqrt(pressed);
  residuals.momentum = residuals.momentum_defect_n_s / scale;
}

/// Angle between the friction force and the one its law asks for at this sliding, rad.
double kineticAngle(const CoulombLaw& law, const Vector2& friction, const Vector2& sliding) {
  return angleBetween(friction,
                      law.anisotropic == nullptr ? Vector2(-sliding) : kineticFriction(law, sliding.normalized()));
}

}  // namespace

TISSUE_CONTACT_CLONES
double bodyDefect(const BodySystem& body, const NodalVectors& v, const NodalVectors& impulses, NodalVectors& defect) {
  const auto nodes = static_cast<std::size_t>(v.cols());
  defect = body.b + impulses;
  for (std::size_t i = 0; i < nodes; ++i) {
    const auto c = static_cast<Eigen::Index>(i);
    const Vector3 v_i = v.col(c);
    Vector3 own = body.stiffness_scale * (body.K->diagonal[i] * v_i) + body.mass[c] * v_i;
    if (body.D != nullptr) own += body.damping_scale * (body.D->diagonal[i] * v_i);
    defect.col(c) -= own;
  }
  addOffDiagonalProduct(*body.K, -body.stiffness_scale, v, defect);
  if (body.D != nullptr) addOffDiagonalProduct(*body.D, -body.damping_scale, v, defect);
  double sum = 0.0;
  for (std::size_t i = 0; i < nodes; ++i) {
    const auto c = static_cast<Eigen::Index>(i);
    if ((*body.fixed)[i]) defect.col(c).setZero();
    sum += defect.col(c).squaredNorm();
  }
  return sum;
}

double loadScale(const ContactProblem& problem) {
  double load = 0.0;
  double mass = 0.0;
  for (const BodySystem& body : problem.bodies) {
    if (body.asleep) continue;
    load += body.b.squaredNorm();
    mass += body.mass.squaredNorm();
  }
  return std::sqrt(load) + kStillSpeed * std::sqrt(mass);
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
    const double u_n = u[0] + row.normal_compliance * solution.impulses[c][0];
    worsen(worst.penetration_m, -(row.gap_m + dt * u_n));
    worsen(worst.adhesion_n, -force[0]);
    worsen(worst.complementarity_w, std::abs(force[0] * (u_n - row.required_u_n)));
    if (state == ContactState::kOpen) continue;
    const Vector2 friction = force.tail<2>();
    const Vector2 sliding = u.tail<2>() + row.tangential_compliance * solution.impulses[c].tail<2>();
    worsen(worst.cone_violation_n, frictionExcess(row.law, force, state != ContactState::kStatic || row.was_sliding));
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
