#include "tissue_contact/solver/residuals.h"

#include <cmath>

namespace tissue_contact {
namespace {

/// std::max would drop a NaN: a worst value that is not a number must stay visible.
void worsen(double& worst, double value) {
  if (!(value <= worst)) worst = value;
}

/// |A v - b - J'lambda| / |J'lambda| over all bodies.
double momentumResidual(const ContactProblem& problem, const ContactSolution& solution,
                        std::vector<NodalVectors>& contact_impulses) {
  for (NodalVectors& p : contact_impulses) p.setZero();
  for (std::size_t c = 0; c < problem.contacts.size(); ++c) {
    const ContactRow& row = problem.contacts[c];
    const Vector3 impulse = row.R_WC * solution.impulses[c];
    for (int a = 0; a < 3; ++a) {
      if (!(*problem.bodies[row.body].fixed)[row.nodes[a]]) {
        contact_impulses[row.body].col(row.nodes[a]) += row.weights[a] * impulse;
      }
    }
  }
  double defect = 0.0;
  double scale = 0.0;
  for (std::size_t k = 0; k < problem.bodies.size(); ++k) {
    const BodySystem& body = problem.bodies[k];
    const NodalVectors& v = solution.v[k];
    for (int i = 0; i < body.K->rows(); ++i) {
      if ((*body.fixed)[i]) continue;
      const Vector3 elastic = body.K->diagonal[i] * v.col(i) + body.K->offDiagonalProduct(i, v);
      const Vector3 p = contact_impulses[k].col(i);
      defect += (body.mass[i] * v.col(i) + body.stiffness_scale * elastic - body.b.col(i) - p).squaredNorm();
      scale += p.squaredNorm();
    }
  }
  if (std::isnan(defect)) return defect;
  return scale == 0.0 ? 0.0 : std::sqrt(defect / scale);
}

}  // namespace

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
    const double mu = state == ContactState::kStatic && !row.was_sliding ? row.law.mu_static : row.law.mu_kinetic;
    worsen(worst.cone_violation_n, friction.norm() - mu * force[0]);
    if (state == ContactState::kStatic) {
      worsen(worst.static_slip_m_per_s, sliding.norm());
    } else if (friction.norm() > 0.0 && sliding.norm() > 0.0) {
      const double cross = friction.x() * sliding.y() - friction.y() * sliding.x();
      worsen(worst.kinetic_angle_rad, std::abs(std::atan2(cross, -friction.dot(sliding))));
    }
  }
  worst.momentum = momentumResidual(problem, solution, scratch);
  return worst;
}

}  // namespace tissue_contact
