#include <algorithm>
#include <limits>

#include "simulation/simulator_implementation.h"

namespace tissue_contact {

/// Fresh states, all nodes awake, and a solver without anything left from the old ones.
void Simulator::Implementation::makeElasticStates() {
  for (std::size_t t = 0; t < tissues.size(); ++t) {
    elastic_states[t].reset();  // or else a large tissue would hold two for a moment
    elastic_states[t] = tissues[t].elasticity().makeState();
    elastic_states[t]->adapt_rotations = scene.advisor.adapt_rotations;
    const Elasticity::State& state = *elastic_states[t];
    BodySystem& body = problem.bodies[t];
    body.K = &state.stiffness;
    body.D = state.damping.rows() > 0 ? &state.damping : nullptr;
    body.fixed = &tissues[t].fixed();
    if (!sleep.empty()) {
      sleep[t].wakeAll();
      body.fixed = &sleep[t].still();
    }
  }
  still_changed.assign(tissues.size(), false);
  solver->reset();
}

/// Nodes that contacts act on wake before anything is computed with them.
void Simulator::Implementation::wakeTouched() {
  for (std::size_t t = 0; t < sleep.size(); ++t) {
    const int before = sleep[t].sleepers();
    if (before == 0) continue;
    for (const Contact& contact : contacts) {
      for (int i = 0; i < 3; ++i) {
        if (contact.key.tissue == static_cast<int>(t) && contact.weights[i] != 0.0) sleep[t].touch(contact.nodes[i]);
        if (contact.key.other_tissue == static_cast<int>(t) && contact.other_weights[i] != 0.0) {
          sleep[t].touch(contact.other_nodes[i]);
        }
      }
    }
    if (sleep[t].sleepers() != before) still_changed[t] = true;
  }
}

void Simulator::Implementation::assembleTissues(double dt) {
  problem.dt_s = dt;
  for (std::size_t t = 0; t < tissues.size(); ++t) {
    const Tissue& tissue = tissues[t];
    BodySystem& body = problem.bodies[t];
    body.asleep = !sleep.empty() && sleep[t].allAsleep();
    if (body.asleep) continue;
    if (still_changed[t]) tissue.elasticity().holdStill(sleep[t].still(), x[t], *elastic_states[t]);
    still_changed[t] = false;
    tissue.elasticity().update(x[t], *elastic_states[t], loads[t]);
    body.stiffness_scale = dt * (dt + tissue.damping().stiffness_s);
    body.damping_scale = body.D != nullptr ? dt : 0.0;
    body.mass = (1.0 + dt * tissue.damping().mass_per_s) * tissue.nodeMasses();
    body.b = solution.v[t] * tissue.nodeMasses().asDiagonal();
    body.b += dt * loads[t];
    body.b += (dt * scene.gravity_m_per_s2) * tissue.nodeMasses().transpose();
    if (!sleep.empty()) loads[t] += scene.gravity_m_per_s2 * tissue.nodeMasses().transpose();
    for (int i = 0; i < tissue.nodeCount(); ++i) {
      if ((*body.fixed)[i]) body.b.col(i).setZero();
    }
  }
}

/// Solves the step, again where it shows that sleeping nodes must move.
void Simulator::Implementation::solveContacts(double dt) {
  report.iterations = 0;
  for (int repeats = 0;; ++repeats) {
    const SolverReport solver_report = solver->solve(problem, solution);
    report.iterations += solver_report.iterations;
    report.stop = solver_report.stop;
    report.residuals = solver_report.residuals;
    if (!wakeHeld(dt, repeats)) return;
  }
}

/// @return whether some nodes woke, with which the step is to be solved again.
bool Simulator::Implementation::wakeHeld(double dt, int repeats) {
  bool any = false;
  report.sleeping_nodes = 0;
  report.held_force_n = 0.0;
  for (std::size_t t = 0; t < sleep.size(); ++t) {
    BodySystem& body = problem.bodies[t];
    if (sleep[t].wakeHeld(loads[t], solution.v[t], dt, allowedHeldForce(t, dt), repeats, touched_nodes)) {
      for (const int node : touched_nodes) body.b.col(node) = dt * loads[t].col(node);  // they were at rest
      still_changed[t] = any = true;
    }
    report.sleeping_nodes += sleep[t].sleepers();
    report.held_force_n += sleep[t].heldForce();
  }
  return any;
}

/// What the sleepers of a tissue may be held by in all, N.
double Simulator::Implementation::allowedHeldForce(std::size_t tissue, double dt) const {
  // The weakest of the net forces of instruments and of other tissues counts: none of them may be off by more.
  double weakest = std::numeric_limits<double>::infinity();
  bool pressed = false;
  const int partners = static_cast<int>(instruments.size() + tissues.size());
  for (int partner = 0; partner < partners; ++partner) {
    const int other = partner - static_cast<int>(instruments.size());
    Vector3 net = Vector3::Zero();
    bool acts = false;
    for (std::size_t c = 0; c < contacts.size(); ++c) {
      const ContactKey& key = contacts[c].key;
      const bool here = key.tissue == static_cast<int>(tissue) || key.other_tissue == static_cast<int>(tissue);
      const bool by = other < 0 ? key.instrument == partner
                                : key.instrument < 0 && (key.tissue == other || key.other_tissue == other);
      if (!here || !by || solution.impulses[c].isZero(0.0)) continue;
      acts = true;
      net += contacts[c].R_WC * solution.impulses[c];
    }
    if (!acts || other == static_cast<int>(tissue)) continue;
    pressed = true;
    weakest = std::min(weakest, net.norm() / dt);
  }
  return scene.advisor.sleep_error * (pressed ? weakest : sleep[tissue].ownForce());
}

void Simulator::Implementation::moveTissues(double dt) {
  bool finite = true;
  for (std::size_t t = 0; t < tissues.size(); ++t) {
    finite = finite && (problem.bodies[t].asleep || solution.v[t].allFinite());
  }
  for (const Vector3& impulse : solution.impulses) finite = finite && impulse.allFinite();
  if (finite) {
    for (std::size_t t = 0; t < tissues.size(); ++t) {
      if (!problem.bodies[t].asleep) x[t] += dt * solution.v[t];
    }
    return;
  }
  report.discarded = true;
  report.stop = StopReason::kIterations;
  report.residuals = Residuals();
  report.sleeping_nodes = 0;
  report.held_force_n = 0.0;
  makeElasticStates();  // what is not finite may have got into tangents and factors
  for (NodalVectors& v : solution.v) v.setZero();
  for (Vector3& impulse : solution.impulses) impulse.setZero();
  std::fill(solution.states.begin(), solution.states.end(), ContactState::kOpen);
}

/// Lets tissues sleep on what the step before has left, of `dt` (0: there was none).
void Simulator::Implementation::restTissues(double dt) {
  if (!(dt > 0.0)) return;
  for (std::size_t t = 0; t < sleep.size(); ++t) {
    if (!sleep[t].looks(dt)) continue;
    touched_nodes.clear();
    for (const Contact& contact : contacts) {
      for (int i = 0; i < 3; ++i) {
        if (contact.key.tissue == static_cast<int>(t) && contact.weights[i] != 0.0)
          touched_nodes.push_back(contact.nodes[i]);
        if (contact.key.other_tissue == static_cast<int>(t) && contact.other_weights[i] != 0.0) {
          touched_nodes.push_back(contact.other_nodes[i]);
        }
      }
    }
    if (!sleep[t].rest(x[t], loads[t], allowedHeldForce(t, dt), touched_nodes)) continue;
    still_changed[t] = true;
    for (int i = 0; i < tissues[t].nodeCount(); ++i) {
      if (sleep[t].still()[i]) solution.v[t].col(i).setZero();
    }
  }
}

}  // namespace tissue_contact
