#include <algorithm>

#include "simulation/simulator_implementation.h"

namespace tissue_contact {
namespace {

/// A deep contact is pushed out by at most this share of the shape's smallest half extent per step: an instrument that
/// starts inside the tissue is then freed over some steps instead of by an explosion.
constexpr double kRecoveryPerStep = 0.1;

/// More of a static contact's slip than this share of an edge is no error of the solver any more and is let go.
constexpr double kMostSlipPerEdge = 0.01;

/// The share of the step that is over when a contact without a history touches, by the velocities `v` of the tissues at the
/// start of the step: tissue and tool go on with them until then. If they would not touch that way, something else brings
/// them together (weight, say, on tissue that lies on a table but for round-off), and the gap counts for as long as it takes
/// to move by it in any direction.
double shareBeforeTouch(const ContactRow& row, const std::vector<NodalVectors>& v, double dt) {
  if (!(row.gap_m > 0.0)) return 0.0;
  const Vector3 u = relativeVelocity(row, v);
  const double way = -dt * u[0] > row.gap_m ? -dt * u[0] : dt * u.norm();
  return way > row.gap_m ? row.gap_m / way : 1.0;
}

}  // namespace

void Simulator::Implementation::assembleContacts(double dt) {
  memory.recall(contacts, motion.longestTravel() + mean_edge, answers);
  problem.contacts.resize(contacts.size());
  solution.impulses.resize(contacts.size());
  solution.states.resize(contacts.size());
  taken_back.resize(contacts.size());
  before_touch.resize(contacts.size());
  for (std::size_t c = 0; c < contacts.size(); ++c) {
    const Contact& contact = contacts[c];
    const ContactMemory::Inherited& before = answers[c];
    ContactRow& row = problem.contacts[c];
    placeRow(contact, dt, row);
    row.was_sliding = before.state == ContactState::kKinetic;
    const double speed = row.was_sliding && last_dt > 0.0 ? before.slip_W.norm() / last_dt : 0.0;
    row.law = friction.at(contact, x, motion.startPoses(), speed);
    taken_back[c].setZero();
    if (before.state == ContactState::kStatic) {
      // Not faster than it came: a short step after a long one could not hold it.
      taken_back[c] = contact.R_WC.rightCols<2>().transpose() * before.slip_W / std::max(dt, last_dt);
      row.u_tool.tail<2>() -= taken_back[c];
    }
    solution.impulses[c] = dt * (contact.R_WC.transpose() * before.force_W);
    solution.states[c] = before.state;
  }
  landContacts(dt);
}

/// A contact that begins within the step slides from then on only: what it moved tangentially before it touched goes into
/// the velocity of its tool, for every solver alike (doc/method.md, "Landing").
void Simulator::Implementation::landContacts(double dt) {
  touch_shares.resize(contacts.size());
  patches.clear();
  for (std::size_t c = 0; c < contacts.size(); ++c) {
    const bool touched = answers[c].state != ContactState::kOpen;
    touch_shares[c] = touched ? 0.0 : shareBeforeTouch(problem.contacts[c], solution.v, dt);
    double& first = firstTouch(contacts[c].key);
    first = std::min(first, touch_shares[c]);
  }
  for (std::size_t c = 0; c < contacts.size(); ++c) {
    before_touch[c].setZero();
    if (touch_shares[c] == 0.0) continue;
    ContactRow& row = problem.contacts[c];
    const double share = 0.5 * (firstTouch(contacts[c].key) + touch_shares[c]);
    before_touch[c] = share * relativeVelocity(row, solution.v).tail<2>();
    row.u_tool.tail<2>() += before_touch[c];
  }
}

/// When the patch of a contact touches first, as a share of the step; 1 for a new patch.
double& Simulator::Implementation::firstTouch(const ContactKey& key) {
  const auto same = [&](const Patch& patch) { return sameShapes(patch.key, key); };
  const auto known = std::find_if(patches.rbegin(), patches.rend(), same);  // contacts of a shape follow one another
  if (known != patches.rend()) return known->first_touch;
  patches.push_back({key, 1.0});
  return patches.back().first_touch;
}

/// Nodes, frame, gap and tool velocity of a contact.
void Simulator::Implementation::placeRow(const Contact& contact, double dt, ContactRow& row) const {
  const ContactKey& key = contact.key;
  row.node_count = 0;
  for (int i = 0; i < 3; ++i) {
    if (contact.weights[i] != 0.0) row.nodes[row.node_count++] = {key.tissue, contact.nodes[i], contact.weights[i]};
  }
  row.R_WC = contact.R_WC;
  row.gap_m = contact.gap_m;
  double recovery = 0.0;
  if (key.instrument >= 0) {
    const double to_shape = contact.gap_m + 0.5 * tissues[key.tissue].thickness();
    const Vector3 p_tool = contact.p_WC - to_shape * contact.R_WC.col(0);
    row.u_tool = contact.R_WC.transpose() * motion.pointVelocity(key.instrument, key.link, p_tool, dt);
    recovery = kRecoveryPerStep * motion.smallestHalfExtent(key.instrument, key.link, key.shape);
  } else {
    for (int i = 0; i < 3; ++i) {
      if (contact.other_weights[i] == 0.0) continue;
      row.nodes[row.node_count++] = {key.other_tissue, contact.other_nodes[i], -contact.other_weights[i]};
    }
    row.u_tool.setZero();
    recovery = kRecoveryPerStep * mean_edge;
  }
  row.required_u_n = std::min(-contact.gap_m, recovery) / dt;
}

void Simulator::Implementation::recordContacts(double dt) {
  solved.resize(contacts.size());
  report.open_contacts = report.static_contacts = report.kinetic_contacts = 0;
  for (std::size_t c = 0; c < contacts.size(); ++c) {
    Contact& contact = contacts[c];
    const NodalVectors& nodes = x[contact.key.tissue];
    contact.p_WC = contact.weights[0] * nodes.col(contact.nodes[0]) + contact.weights[1] * nodes.col(contact.nodes[1]) +
                   contact.weights[2] * nodes.col(contact.nodes[2]);
    answers[c].state = solution.states[c];
    answers[c].force_W = contact.R_WC * solution.impulses[c] / dt;
    answers[c].slip_W = slipOf(c, dt);
    solved[c] = {contact, answers[c].state, answers[c].force_W};
    report.open_contacts += answers[c].state == ContactState::kOpen;
    report.static_contacts += answers[c].state == ContactState::kStatic;
    report.kinetic_contacts += answers[c].state == ContactState::kKinetic;
  }
  memory.remember(contacts, answers);
}

/// Tangential way of a contact in this step, m, world frame; of a static one since it touched, with what earlier steps
/// have left.
Vector3 Simulator::Implementation::slipOf(std::size_t c, double dt) const {
  const Contact& contact = contacts[c];
  Vector2 velocity = relativeVelocity(problem.contacts[c], solution.v).tail<2>() - taken_back[c];
  const bool held = solution.states[c] == ContactState::kStatic;
  if (!held) velocity += before_touch[c];
  Vector3 slip = dt * (contact.R_WC.rightCols<2>() * velocity);
  if (!held) return slip;
  slip += contact.R_WC.rightCols<2>() * taken_back[c] * std::max(dt, last_dt);
  const double most = kMostSlipPerEdge * mean_edge;
  return slip.norm() > most ? Vector3(slip * (most / slip.norm())) : slip;
}

void Simulator::Implementation::sumWrenches() {
  wrenches.assign(instruments.size(), Wrench());
  for (const SolvedContact& contact : solved) {
    const ContactKey& key = contact.contact.key;
    if (key.instrument < 0) continue;
    const Pose& X_WTip = motion.startPoses()[key.instrument][instruments[key.instrument].tipLink()];
    const Vector3 force_W = -contact.force_on_tissue_n;
    Wrench& wrench = wrenches[key.instrument];
    wrench.force += X_WTip.linear().transpose() * force_W;
    wrench.torque += X_WTip.linear().transpose() * (contact.contact.p_WC - X_WTip.translation()).cross(force_W);
  }
}

}  // namespace tissue_contact
