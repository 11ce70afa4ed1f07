#include "tissue_contact/solver/iterative_predictor_corrector.h"

#include <Eigen/LU>
#include <cmath>

#include "tissue_contact/core/check.h"

namespace tissue_contact {

IterativePredictorCorrector::IterativePredictorCorrector(const SolverOptions& options) : options_(options) {
  requirePositive("solver iterations", options.iterations);
  requirePositive("solver contact_passes", options.contact_passes);
  requirePositive("solver tolerance", options.tolerance);
}

void IterativePredictorCorrector::prepareBodies(const ContactProblem& problem) {
  block_inverse_.resize(problem.bodies.size());
  contact_impulses_.resize(problem.bodies.size());
  scratch_.resize(problem.bodies.size());
  double load = 0.0;
  for (std::size_t k = 0; k < problem.bodies.size(); ++k) {
    const BodySystem& body = problem.bodies[k];
    const int nodes = body.K->rows();
    block_inverse_[k].resize(nodes);
    for (int i = 0; i < nodes; ++i) {
      Matrix3 block = body.stiffness_scale * body.K->diagonal[i];
      block.diagonal().array() += body.mass[i];
      block_inverse_[k][i] = (*body.fixed)[i] ? Matrix3(Matrix3::Zero()) : Matrix3(block.inverse());
    }
    contact_impulses_[k].setZero(3, nodes);
    scratch_[k].resize(3, nodes);
    load += body.b.squaredNorm();
  }
  load_scale_ = std::sqrt(load);
}

void IterativePredictorCorrector::prepareContacts(const ContactProblem& problem, ContactSolution& solution) {
  prepared_.resize(problem.contacts.size());
  for (std::size_t c = 0; c < problem.contacts.size(); ++c) {
    const ContactRow& row = problem.contacts[c];
    Prepared& contact = prepared_[c];
    contact.W.setZero();
    contact.flips = 0;
    for (int a = 0; a < 3; ++a) {
      const Matrix3& inverse = block_inverse_[row.body][row.nodes[a]];
      contact.response[a] = row.weights[a] * (inverse * row.R_WC);
      const bool fixed = (*problem.bodies[row.body].fixed)[row.nodes[a]];
      contact.distribution[a] = fixed ? Matrix3(Matrix3::Zero()) : Matrix3(row.weights[a] * row.R_WC);
      contact.W += row.weights[a] * (row.R_WC.transpose() * contact.response[a]);
    }
    contact.usable = contact.W(0, 0) > 0.0;
    if (!contact.usable) {
      solution.impulses[c].setZero();
      solution.states[c] = ContactState::kOpen;
    }
    NodalVectors& p = contact_impulses_[row.body];
    for (int a = 0; a < 3; ++a) p.col(row.nodes[a]) += contact.distribution[a] * solution.impulses[c];
  }
}

double IterativePredictorCorrector::sweep(const ContactProblem& problem, bool forward,
                                          std::vector<NodalVectors>& v) const {
  double change = 0.0;
  for (std::size_t k = 0; k < problem.bodies.size(); ++k) {
    const BodySystem& body = problem.bodies[k];
    const BlockMatrix& K = *body.K;
    const int nodes = K.rows();
    for (int step = 0; step < nodes; ++step) {
      const int i = forward ? step : nodes - 1 - step;
      if ((*body.fixed)[i]) continue;
      const Vector3 v_i = v[k].col(i);
      const Vector3 elastic = K.offDiagonalProduct(i, v[k]) + K.diagonal[i] * v_i;
      const Vector3 defect =
          body.b.col(i) + contact_impulses_[k].col(i) - body.mass[i] * v_i - body.stiffness_scale * elastic;
      v[k].col(i) = v_i + block_inverse_[k][i] * defect;
      change += defect.squaredNorm();
    }
  }
  return std::sqrt(change);
}

double IterativePredictorCorrector::contactPass(const ContactProblem& problem, ContactSolution& solution) {
  double change = 0.0;
  for (std::size_t c = 0; c < problem.contacts.size(); ++c) {
    Prepared& contact = prepared_[c];
    if (!contact.usable) continue;
    const ContactRow& row = problem.contacts[c];
    Vector3& impulse = solution.impulses[c];
    Vector3 q = relativeVelocity(row, solution.v) - contact.W * impulse;
    q[0] -= row.required_u_n;
    const bool kinetic_limit = row.was_sliding || contact.flips > kMaxFlips;
    const ContactAnswer answer = solveCoulombContact(contact.W, q, row.law, kinetic_limit);
    const bool both_touch = answer.state != ContactState::kOpen && solution.states[c] != ContactState::kOpen;
    if (both_touch && answer.state != solution.states[c]) ++contact.flips;
    solution.states[c] = answer.state;
    const Vector3 delta = answer.impulse - impulse;
    impulse = answer.impulse;
    for (int a = 0; a < 3; ++a) {
      solution.v[row.body].col(row.nodes[a]) += contact.response[a] * delta;
      contact_impulses_[row.body].col(row.nodes[a]) += contact.distribution[a] * delta;
    }
    change += delta.squaredNorm();
  }
  return std::sqrt(change);
}

bool IterativePredictorCorrector::small(double momentum_change, double impulse_change,
                                        const ContactSolution& solution) const {
  double impulses = 0.0;
  for (const Vector3& impulse : solution.impulses) impulses += impulse.squaredNorm();
  impulses = std::sqrt(impulses);
  return momentum_change <= options_.tolerance * (load_scale_ + impulses) &&
         impulse_change <= options_.tolerance * impulses;
}

SolverReport IterativePredictorCorrector::solve(const ContactProblem& problem, ContactSolution& solution) {
  prepareBodies(problem);
  prepareContacts(problem, solution);
  SolverReport report;
  while (report.iterations < options_.iterations && !report.converged) {
    const double momentum_change = sweep(problem, report.iterations % 2 == 0, solution.v);
    double impulse_change = 0.0;
    for (int pass = 0; pass < options_.contact_passes; ++pass) {
      const double pass_change = contactPass(problem, solution);
      if (pass == 0) impulse_change = pass_change;
    }
    ++report.iterations;
    report.converged = small(momentum_change, impulse_change, solution);
  }
  report.residuals = computeResiduals(problem, solution, scratch_);
  return report;
}

}  // namespace tissue_contact
