#include "simulation/step_contacts.h"

#include <algorithm>
#include <cmath>
#include <limits>

#include "tissue_contact/mesh/tissue_surface.h"
#include "tissue_contact/simulation/touched_point.h"

namespace tissue_contact {
namespace {

/// A deep contact is pushed out by at most the shape's smallest half extent in this time: an instrument that starts
/// inside the tissue is then freed over some steps instead of by an explosion, and as fast at any step.
constexpr double kRecoveryTime_s = 0.01;

/// More of a static contact's slip than this share of an edge is no error of the solver any more and is let go.
constexpr double kMostSlipPerEdge = 0.01;

/// The share of the step that is over when a contact without a history touches, by the velocities `v` of the tissues at
/// the start of the step: tissue and tool go on with them until then. If they would not touch that way, something else
/// brings them together (weight, say, on tissue that lies on a table but for round-off), and the gap counts for as long
/// as it takes to move by it in any direction.
double shareBeforeTouch(const ContactRow& row, const std::vector<NodalVectors>& v, double dt) {
  if (!(row.gap_m > 0.0)) return 0.0;
  const Vector3 u = relativeVelocity(row, v);
  const double way = -dt * u[0] > row.gap_m ? -dt * u[0] : dt * u.norm();
  return way > row.gap_m ? row.gap_m / way : 1.0;
}

/// A point of a surface whose nodes have other numbers now; where one of them is no more, of no feature and without weight.
void renumberPoint(const std::vector<int>& to_new, std::array<int, 3>& feature, std::array<int, 3>& nodes,
                   Vector3& weights) {
  bool is_there = true;
  for (int i = 0; i < 3; ++i) is_there &= weights[i] == 0.0 || to_new[nodes[i]] >= 0;
  for (const int node : feature) is_there &= node < 0 || to_new[node] >= 0;
  for (int i = 0; i < 3; ++i) {
    nodes[i] = std::max(to_new[nodes[i]], 0);  // one without a weight need not be there
    if (feature[i] >= 0) feature[i] = is_there ? to_new[feature[i]] : -1;
  }
  if (!is_there) weights.setZero();
  const auto end = std::find(feature.begin(), feature.end(), -1);
  std::sort(feature.begin(), end);
}

void carryContact(StateArchive& archive, SolvedContact& solved) {
  Contact& contact = solved.contact;
  ContactKey& key = contact.key;
  for (int* const index :
       {&key.tissue, &key.instrument, &key.link, &key.shape, &key.corner, &key.slot, &key.other_tissue}) {
    archive.carry(*index);
  }
  for (std::array<int, 3>* const nodes : {&key.feature, &key.other_feature, &contact.nodes, &contact.other_nodes}) {
    archive.carry(*nodes);
  }
  for (Vector3* const vector :
       {&contact.weights, &contact.p_WC, &contact.other_weights, &solved.force_on_tissue_n, &solved.slip_W}) {
    archive.carry(*vector);
  }
  archive.carry(contact.R_WC);
  archive.carry(contact.gap_m);
  archive.carry(solved.state);
}

}  // namespace

void sumImpulsesOn(int tissue, const std::vector<SolvedContact>& contacts, const std::vector<Vector3>& impulses,
                   std::vector<NetImpulse>& net) {
  net.clear();
  for (std::size_t c = 0; c < contacts.size(); ++c) {
    const ContactKey& key = contacts[c].contact.key;
    const bool on_tissue = key.tissue == tissue;  // else on the side that n points away from
    if (on_tissue == (key.other_tissue == tissue) || impulses[c].isZero(0.0)) continue;
    const int other = on_tissue ? key.other_tissue : key.tissue;
    const auto is_same = [&](const NetImpulse& one) {
      return one.instrument == key.instrument && one.other_tissue == other;
    };
    auto of_partner = std::find_if(net.begin(), net.end(), is_same);
    if (of_partner == net.end()) of_partner = net.insert(net.end(), {key.instrument, other, Vector3::Zero()});
    const Vector3 impulse_W = contacts[c].contact.R_WC * impulses[c];
    if (on_tissue) {
      of_partner->impulse_W += impulse_W;
    } else {
      of_partner->impulse_W -= impulse_W;
    }
  }
}

StepContacts::StepContacts(const std::vector<Tissue>& tissues, const InstrumentMotion& motion,
                           const FrictionTable& friction, const SurfaceEdges& edges)
    : tissues_(tissues),
      motion_(motion),
      friction_(friction),
      edges_(edges),
      thickness_(tissues),
      turning_(tissues),
      settling_(tissues.size(), edges) {
  if (friction.dependsOnPressure()) pressure_.emplace(tissues);
}

void StepContacts::clear() {
  memory_.clear();
  if (pressure_) pressure_->clear();
  contacts_.clear();
  settling_.clear();
}

void StepContacts::begin(const ContactDetector& detector, const std::vector<NodalVectors>& x,
                         const DetectionMargins& margins, std::vector<Contact>& found) {
  const auto is_far = [&](const Contact& contact) { return contact.gap_m > margins.at(contact); };
  const auto drop_far = [&] { found.erase(std::remove_if(found.begin(), found.end(), is_far), found.end()); };
  drop_far();
  memory_.addKeptPoints(detector, x, motion_.startPoses(), margins.ofTissues(), found);
  drop_far();
  reaches_m_.resize(found.size());
  for (std::size_t c = 0; c < found.size(); ++c) reaches_m_[c] = motion_.longestTravel() + edges_.finer(found[c]);
  memory_.recall(found, reaches_m_, contacts_);
  settling_.begin(found);
}

void StepContacts::slideOn(const ContactDetector& detector, const std::vector<NodalVectors>& v, double dt) {
  for (SolvedContact& solved : contacts_) {
    Contact& contact = solved.contact;
    if (contact.key.instrument < 0) continue;
    const ContactKey& key = contact.key;
    const Vector3 v_W =
        solved.state == ContactState::kStatic
            ? motion_.pointVelocity(key.instrument, key.link, touchedPoint(contact, tissues_), dt)  // held by it
            : pointOf(v[key.tissue], contact.nodes, contact.weights);
    detector.turnWithSlide(motion_.startPoses(), motion_.endPoses(), dt * v_W, contact);
  }
}

void StepContacts::touchedNodes(int tissue, std::vector<int>& nodes) const {
  nodes.clear();
  for (const SolvedContact& solved : contacts_) {
    const Contact& contact = solved.contact;
    for (int i = 0; i < 3; ++i) {
      if (contact.key.tissue == tissue && contact.weights[i] != 0.0) nodes.push_back(contact.nodes[i]);
      if (contact.key.other_tissue == tissue && contact.other_weights[i] != 0.0) {
        nodes.push_back(contact.other_nodes[i]);
      }
    }
  }
}

void StepContacts::assemble(const std::vector<NodalVectors>& x, double dt, double last_dt,
                            std::vector<ContactRow>& rows, ContactSolution& solution) {
  rows.resize(contacts_.size());
  solution.impulses.resize(contacts_.size());
  solution.states.resize(contacts_.size());
  u_besides_.resize(contacts_.size());
  thickness_.prepare(contacts_);
  turning_.prepare(contacts_, x, solution.v);
  back_time_s_ = std::max(dt, last_dt);  // not faster than it came: a short step after a long one could not hold it
  for (std::size_t c = 0; c < contacts_.size(); ++c) {
    const SolvedContact& before = contacts_[c];
    const Matrix3& R_WC = before.contact.R_WC;
    ContactRow& row = rows[c];
    placeRow(c, dt, row);
    row.u_tool.tail<2>() += R_WC.rightCols<2>().transpose() * turning_.at(before.contact);
    row.was_sliding = before.state == ContactState::kKinetic;
    row.was_static = before.state == ContactState::kStatic;
    const double speed_over_tissue = relativeVelocity(row, solution.v).tail<2>().norm();
    row.law = friction_.at(before.contact, x, motion_.startPoses(), beforeOf(before, x, last_dt, speed_over_tissue));
    u_besides_[c].setZero();
    if (before.state == ContactState::kStatic) {
      u_besides_[c] = -(R_WC.rightCols<2>().transpose() * before.slip_W) / back_time_s_;
      row.u_tool.tail<2>() += u_besides_[c];
    }
    solution.impulses[c] = dt * (R_WC.transpose() * before.force_on_tissue_n);
    row.u_tool.tail<2>() +=
        row.tangential_compliance * dt * (R_WC.rightCols<2>().transpose() * memory_.frictionBefore(c));
    solution.states[c] = before.state;
  }
  land(solution.v, dt, rows);
  settling_.advance(dt);
}

/// @param speed_over_tissue tangential speed of what touches over the tissue here as the last step ended, m/s. A contact that was open has
/// no slip of its own, so this stands for it: whether its point has just come under the tool, takes another's place, or lands in this step.
ContactBefore StepContacts::beforeOf(const SolvedContact& inherited, const std::vector<NodalVectors>& x, double last_dt,
                                     double speed_over_tissue) const {
  ContactBefore before;
  if (inherited.state == ContactState::kOpen) before.sliding_speed = speed_over_tissue;
  if (inherited.state == ContactState::kKinetic && last_dt > 0.0) {
    before.sliding_speed = inherited.slip_W.norm() / last_dt;
  }
  if (pressure_) before.pressure = pressure_->at(inherited.contact, x);
  return before;
}

/// A contact that begins within the step slides from then on only: what it moved tangentially before it touched goes
/// into the velocity of its tool, for every solver alike (doc/method.md, "Contact frames and landing").
void StepContacts::land(const std::vector<NodalVectors>& v, double dt, std::vector<ContactRow>& rows) {
  touch_shares_.resize(contacts_.size());
  patches_.clear();
  for (std::size_t c = 0; c < contacts_.size(); ++c) {
    const bool touched = contacts_[c].state != ContactState::kOpen;
    touch_shares_[c] = touched ? 0.0 : shareBeforeTouch(rows[c], v, dt);
    double& first = firstTouch(contacts_[c].contact.key);
    first = std::min(first, touch_shares_[c]);
  }
  for (std::size_t c = 0; c < contacts_.size(); ++c) {
    if (touch_shares_[c] == 0.0) continue;
    const double share = 0.5 * (firstTouch(contacts_[c].contact.key) + touch_shares_[c]);
    u_besides_[c] = share * relativeVelocity(rows[c], v).tail<2>();
    rows[c].u_tool.tail<2>() += u_besides_[c];
  }
}

/// When the patch of a contact touches first, as a share of the step; 1 for a new patch.
double& StepContacts::firstTouch(const ContactKey& key) {
  const auto same = [&](const Patch& patch) { return sameShapes(patch.key, key); };
  const auto known = std::find_if(patches_.rbegin(), patches_.rend(), same);  // contacts of a shape follow one another
  if (known != patches_.rend()) return known->first_touch;
  patches_.push_back({key, 1.0});
  return patches_.back().first_touch;
}

/// Nodes, frame, gap, what gives way and tool velocity of a contact.
void StepContacts::placeRow(std::size_t index, double dt, ContactRow& row) const {
  const Contact& contact = contacts_[index].contact;
  const ContactKey& key = contact.key;
  row.node_count = 0;
  row.pair = key.instrument >= 0 ? key.instrument : -1 - key.other_tissue;
  for (int i = 0; i < 3; ++i) {
    if (contact.weights[i] != 0.0) row.nodes[row.node_count++] = {key.tissue, contact.nodes[i], contact.weights[i]};
  }
  row.R_WC = contact.R_WC;
  row.gap_m = contact.gap_m;
  double half_extent = 0.0;
  if (key.instrument >= 0) {
    const double to_shape = contact.gap_m + 0.5 * tissues_[key.tissue].thickness();
    const Vector3 p_tool = contact.p_WC - to_shape * contact.R_WC.col(0);
    row.u_tool = contact.R_WC.transpose() * motion_.pointVelocity(key.instrument, key.link, p_tool, dt);
    half_extent = motion_.smallestHalfExtent(key.instrument, key.link, key.shape);
  } else {
    for (int i = 0; i < 3; ++i) {
      if (contact.other_weights[i] == 0.0) continue;
      row.nodes[row.node_count++] = {key.other_tissue, contact.other_nodes[i], -contact.other_weights[i]};
    }
    row.u_tool.setZero();
    half_extent = edges_.finer(contact);
  }
  const SheetCompliance compliance = thickness_.complianceOf(index);
  row.normal_compliance = compliance.normal / (dt * dt);
  row.tangential_compliance = compliance.tangential / (dt * dt);
  // A sheet that is squeezed is no deeper than its force makes it.
  const double force = std::max(contact.R_WC.col(0).dot(contacts_[index].force_on_tissue_n), 0.0);
  const double depth = row.gap_m < 0.0 ? std::max(-row.gap_m - settling_.depth(key), 0.0) : -row.gap_m;
  row.required_u_n = std::min(depth / dt, half_extent / kRecoveryTime_s + compliance.normal * force / dt);
}

std::optional<double> StepContacts::weakestNetForce(int tissue, const std::vector<Vector3>& impulses, double dt) {
  sumImpulsesOn(tissue, contacts_, impulses, net_);
  std::optional<double> weakest;
  for (const NetImpulse& net : net_) {
    weakest = std::min(weakest.value_or(std::numeric_limits<double>::infinity()), net.impulse_W.norm() / dt);
  }
  return weakest;
}

void StepContacts::record(const std::vector<NodalVectors>& x, const ContactProblem& problem,
                          const ContactSolution& solution) {
  for (std::size_t c = 0; c < contacts_.size(); ++c) {
    SolvedContact& solved = contacts_[c];
    Contact& contact = solved.contact;
    contact.p_WC = pointOf(x[contact.key.tissue], contact.nodes, contact.weights);
    solved.slip_W = slipOf(c, problem, solution);
    solved.state = solution.states[c];
    solved.force_on_tissue_n = contact.R_WC * solution.impulses[c] / problem.dt_s;
  }
  memory_.remember(contacts_);
  if (pressure_) pressure_->remember(contacts_);
}

/// Tangential way of a contact in this step, m, world frame; of a static one since it touched, with what earlier steps
/// have left.
Vector3 StepContacts::slipOf(std::size_t c, const ContactProblem& problem, const ContactSolution& solution) const {
  const auto tangents = contacts_[c].contact.R_WC.rightCols<2>();
  const ContactState before = contacts_[c].state;
  const bool held = solution.states[c] == ContactState::kStatic;
  const bool lands = before == ContactState::kOpen;
  Vector2 u_t = slidingVelocity(problem.contacts[c], solution.v, solution.impulses[c]);
  if (!held || !lands) u_t += u_besides_[c];
  Vector3 slip = problem.dt_s * (tangents * u_t);
  if (!held) return slip;
  if (before == ContactState::kStatic) slip -= tangents * u_besides_[c] * back_time_s_;
  const double most = kMostSlipPerEdge * edges_.finer(contacts_[c].contact);
  return slip.norm() > most ? Vector3(slip * (most / slip.norm())) : slip;
}

void StepContacts::renumber(int tissue, const std::vector<int>& to_new, TrianglesOfNodes& triangles) {
  if (pressure_) pressure_->swapSurface(tissue, triangles);
  for (SolvedContact& solved : contacts_) {
    Contact& contact = solved.contact;
    if (contact.key.tissue == tissue) renumberPoint(to_new, contact.key.feature, contact.nodes, contact.weights);
    if (contact.key.other_tissue == tissue) {
      renumberPoint(to_new, contact.key.other_feature, contact.other_nodes, contact.other_weights);
    }
  }
}

void StepContacts::finishRenumbering() {
  std::sort(contacts_.begin(), contacts_.end(),
            [](const SolvedContact& a, const SolvedContact& b) { return a.contact.key < b.contact.key; });
  memory_.remember(contacts_);
  if (pressure_) pressure_->remember(contacts_);
}

void StepContacts::carry(StateArchive& archive, const std::vector<Instrument>& instruments) {
  constexpr std::size_t kMost = 10'000'000;
  archive.carryList(contacts_, kMost, [&](SolvedContact& solved) {
    carryContact(archive, solved);
    if (archive.isReading()) requireContact(archive, solved, instruments);
  });
  settling_.carry(archive);
  if (!archive.isReading()) return;
  const auto ordered = [](const SolvedContact& a, const SolvedContact& b) { return a.contact.key < b.contact.key; };
  archive.check(std::is_sorted(contacts_.begin(), contacts_.end(), ordered), "contacts out of their order");
  memory_.remember(contacts_);
  if (pressure_) pressure_->remember(contacts_);
}

/// Its nodes, shapes and numbers are such as there are.
void StepContacts::requireContact(const StateArchive& archive, const SolvedContact& solved,
                                  const std::vector<Instrument>& instruments) const {
  const Contact& contact = solved.contact;
  const ContactKey& key = contact.key;
  archive.requireIndex(key.slot, 0, ContactMemory::kKeptPoints + 1, "the slot");
  const auto require_point = [&](int tissue, const std::array<int, 3>& feature, const std::array<int, 3>& nodes) {
    archive.requireIndex(tissue, 0, tissues_.size(), "the tissue");
    const auto count = static_cast<std::size_t>(tissues_[tissue].nodeCount());
    for (const int node : nodes) archive.requireIndex(node, 0, count, "the node");
    for (const int node : feature) archive.requireIndex(node, -1, count, "the node");
  };
  require_point(key.tissue, key.feature, contact.nodes);
  if (key.instrument >= 0) {
    archive.requireIndex(key.instrument, 0, instruments.size(), "the instrument");
    const std::vector<ContactLink>& links = instruments[key.instrument].contactLinks();
    archive.requireIndex(key.link, 0, links.size(), "the link");
    archive.requireIndex(key.shape, 0, links[key.link].shapes.size(), "the shape");
    archive.check(key.other_tissue < 0, "a contact of an instrument and a tissue at once");
  } else {
    require_point(key.other_tissue, key.other_feature, contact.other_nodes);
  }
  constexpr double kMost = 1.0 + 1e-6;              // of a barycentric weight, and of a direction's component
  const auto within = [](const auto& components) {  // maxCoeff() passes over NaN
    return components.allFinite() && components.cwiseAbs().maxCoeff() <= kMost;
  };
  const bool is_possible = within(contact.weights) && within(contact.other_weights) && within(contact.R_WC) &&
                           contact.p_WC.allFinite() && std::isfinite(contact.gap_m) &&
                           solved.force_on_tissue_n.allFinite() && solved.slip_W.allFinite();
  archive.check(is_possible, "a contact whose place or force is none");
  archive.requireIndex(static_cast<int>(solved.state), 0, 3, "the state");
}

void StepContacts::keysBetweenTissues(std::vector<ContactKey>& keys) const {
  keys.clear();
  for (const SolvedContact& solved : contacts_) {
    if (solved.contact.key.other_tissue >= 0) keys.push_back(solved.contact.key);
  }
}

int StepContacts::count(ContactState state) const {
  return static_cast<int>(std::count_if(contacts_.begin(), contacts_.end(),
                                        [state](const SolvedContact& contact) { return contact.state == state; }));
}

}  // namespace tissue_contact
