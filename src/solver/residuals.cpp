#include "tissue_contact/solver/residuals.h"

#include <cmath>

#include "core/row_product.h"
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
    pressed += contact_impulses[k].squaredNorm();
    defect += bodyDefect(problem.bodies[k], solution.v[k], contact_impulses[k], contact_impulses[k]);
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

/// @tparam kDamped the body has a damping matrix: known when compiled, so that the others do not ask node by node.
template <bool kDamped>
TISSUE_CONTACT_INLINE double defectOf(const BodySystem& body, const NodalVectors& v, const NodalVectors& impulses,
                                      NodalVectors& defect) {
  const BlockMatrix& K = *body.K;
  const BlockMatrix& D = kDamped ? *body.D : K;
  double sum = 0.0;
  for (int i = 0; i < K.rows(); ++i) {
    if ((*body.fixed)[i]) {
      defect.col(i).setZero();
      continue;
    }
    const Vector3 v_i = v.col(i);
    const Vector3 elastic = rowProduct(K, K.row_start[i], K.row_start[i + 1], v) + blockProduct(K.diagonal[i], v_i);
    Vector3 d = body.b.col(i) + impulses.col(i) - body.mass[i] * v_i - body.stiffness_scale * elastic;
    if (kDamped) {
      d -= body.damping_scale *
           (rowProduct(D, D.row_start[i], D.row_start[i + 1], v) + blockProduct(D.diagonal[i], v_i));
    }
    defect.col(i) = d;
    sum += d.squaredNorm();
  }
  return sum;
}

}  // namespace

TISSUE_CONTACT_CLONES
double bodyDefect(const BodySystem& body, const NodalVectors& v, const NodalVectors& impulses, NodalVectors& defect) {
  return body.D != nullptr ? defectOf<true>(body, v, impulses, defect) : defectOf<false>(body, v, impulses, defect);
}

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
