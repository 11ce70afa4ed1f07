#include "tissue_contact/simulation/simulator.h"

#include <algorithm>
#include <cmath>
#include <optional>
#include <stdexcept>

#include "tissue_contact/contact/contact_detector.h"
#include "tissue_contact/contact/tissue_pair_detector.h"
#include "tissue_contact/core/check.h"
#include "tissue_contact/simulation/contact_memory.h"
#include "tissue_contact/simulation/friction_table.h"
#include "tissue_contact/simulation/instrument_motion.h"

namespace tissue_contact {
namespace {

/// A deep contact is pushed out by at most this share of the shape's smallest half extent per step: an instrument that
/// starts inside the tissue is then freed over some steps instead of by an explosion.
constexpr double kRecoveryPerStep = 0.1;

/// Contacts are looked for this much beyond what present speeds can close in the step: speeds change within a step.
constexpr double kMarginFactor = 1.5;
constexpr double kMarginPerEdge = 0.01;

/// Tissues are looked for this many edges from each other at most: pairs of features grow with the square of it.
constexpr double kMostPairEdges = 2.0;

/// More of a static contact's slip than this share of an edge is no error of the solver any more and is let go.
constexpr double kMostSlipPerEdge = 0.01;

double meanSurfaceEdge(const std::vector<Tissue>& tissues) {
  double sum = 0.0;
  double count = 0.0;
  for (const Tissue& tissue : tissues) {
    const NodalVectors& x = tissue.restPositions();
    for (const Triangle& t : tissue.surface()) sum += (x.col(t[0]) - x.col(t[1])).norm();
    count += static_cast<double>(tissue.surface().size());
  }
  return count > 0.0 ? sum / count : 0.0;
}

std::vector<TissueSurface> surfacesOf(const std::vector<Tissue>& tissues) {
  std::vector<TissueSurface> surfaces;
  surfaces.reserve(tissues.size());
  for (const Tissue& tissue : tissues) surfaces.push_back({tissue.surface(), tissue.fixed(), tissue.thickness()});
  return surfaces;
}

std::vector<NodalVectors> restPositionsOf(const std::vector<Tissue>& tissues) {
  std::vector<NodalVectors> positions;
  positions.reserve(tissues.size());
  for (const Tissue& tissue : tissues) positions.push_back(tissue.restPositions());
  return positions;
}

}  // namespace

struct Simulator::Implementation {
  Implementation(const Scene& description, const SceneEnvironment& environment);
  void reset();
  void step(double dt);
  void detectContacts(double dt);
  void assembleTissues(double dt);
  void assembleContacts(double dt);
  void placeRow(const Contact& contact, double dt, ContactRow& row) const;
  void moveTissues(double dt);
  void recordContacts(double dt);
  Vector3 slipOf(std::size_t contact, double dt) const;
  void makeElasticStates();
  void sumWrenches();

  const Scene scene;
  const std::vector<Instrument> instruments;
  const std::vector<Tissue> tissues;
  const FrictionTable friction;
  const double mean_edge;  ///< of all tissue surfaces, m

  InstrumentMotion motion;
  std::vector<NodalVectors> x;                                     ///< per tissue
  std::vector<std::unique_ptr<Elasticity::State>> elastic_states;  ///< per tissue
  std::vector<NodalVectors> forces;                                ///< elastic, per tissue
  ContactDetector detector;
  std::optional<TissuePairDetector> pair_detector;  ///< only where tissues touch each other
  std::vector<Contact> contacts;
  ContactMemory memory;
  std::vector<ContactMemory::Inherited> answers;  ///< per contact: inherited before the solve, found after it
  std::vector<Vector2> taken_back;  ///< per contact: part of the tool's velocity that undoes a slip, contact plane, m/s
  ContactProblem problem;
  ContactSolution solution;  ///< v is the tissues' velocity
  std::unique_ptr<ContactSolver> solver;
  std::vector<SolvedContact> solved;
  std::vector<Wrench> wrenches;  ///< per instrument
  StepReport report;
  long step_count = 0;
  double last_dt = 0.0;  ///< of the step before, s
  std::function<void()> observer;
};

Simulator::Implementation::Implementation(const Scene& description, const SceneEnvironment& environment)
    : scene(description),
      instruments(buildInstruments(scene, environment)),
      tissues(buildTissues(scene, environment)),
      friction(scene, instruments, tissues),
      mean_edge(meanSurfaceEdge(tissues)),
      motion(instruments),
      detector(instruments, surfacesOf(tissues), restPositionsOf(tissues)),
      solver(makeContactSolver(scene.solver, environment.clock)) {
  requireMethodForLaws(scene);
  requirePositive("step.max_step_s", scene.step.max_step_s, "s");
  if (!scene.tissue_pairs.empty()) {
    pair_detector.emplace(buildTissuePairs(scene), surfacesOf(tissues), restPositionsOf(tissues));
  }
  elastic_states.resize(tissues.size());
  forces = restPositionsOf(tissues);  // for their sizes
  problem.bodies.resize(tissues.size());
  reset();
}

void Simulator::Implementation::reset() {
  motion.reset();
  x = restPositionsOf(tissues);
  solution.v.resize(tissues.size());
  for (std::size_t t = 0; t < tissues.size(); ++t) {
    solution.v[t].setZero(3, tissues[t].nodeCount());
  }
  makeElasticStates();
  memory.clear();
  contacts.clear();
  solved.clear();
  wrenches.assign(instruments.size(), Wrench());
  report = StepReport();
  step_count = 0;
  last_dt = 0.0;
}

/// Fresh states, and a solver without anything left from the old ones.
void Simulator::Implementation::makeElasticStates() {
  for (std::size_t t = 0; t < tissues.size(); ++t) {
    elastic_states[t] = tissues[t].elasticity().makeState();
    const Elasticity::State& state = *elastic_states[t];
    problem.bodies[t].K = &state.stiffness;
    problem.bodies[t].D = state.damping.rows() > 0 ? &state.damping : nullptr;
    problem.bodies[t].fixed = &tissues[t].fixed();
  }
  solver->reset();
}

/// One implicit step: the rooms in order.
void Simulator::Implementation::step(double dt) {
  detectContacts(dt);
  assembleTissues(dt);
  assembleContacts(dt);
  const SolverReport solver_report = solver->solve(problem, solution);
  report.iterations = solver_report.iterations;
  report.stop = solver_report.stop;
  report.residuals = solver_report.residuals;
  moveTissues(dt);
  motion.finishStep();
  ++step_count;
  recordContacts(dt);
  last_dt = dt;
  if (observer) observer();
}

void Simulator::Implementation::detectContacts(double dt) {
  double fastest_squared = 0.0;
  for (const NodalVectors& v : solution.v)
    fastest_squared = std::max(fastest_squared, v.colwise().squaredNorm().maxCoeff());
  const double tissue_travel = dt * (std::sqrt(fastest_squared) + dt * scene.gravity_m_per_s2.norm());
  double margin = kMarginFactor * (motion.longestTravel() + tissue_travel) + kMarginPerEdge * mean_edge;
  // Beyond so many elements nothing touches in one step; the bound also keeps an overflow of the speeds out.
  constexpr double kMostEdges = 1e6;
  margin = std::min(margin, kMostEdges * mean_edge);
  detector.detect(x, motion.startPoses(), margin, contacts);
  if (pair_detector) {
    pair_detector->detect(x, std::min(margin + kMarginFactor * tissue_travel, kMostPairEdges * mean_edge), contacts);
    std::sort(contacts.begin(), contacts.end(), [](const Contact& a, const Contact& b) { return a.key < b.key; });
  }
  memory.addKeptPoints(detector, x, motion.startPoses(), margin, contacts);
}

void Simulator::Implementation::assembleTissues(double dt) {
  problem.dt_s = dt;
  for (std::size_t t = 0; t < tissues.size(); ++t) {
    const Tissue& tissue = tissues[t];
    BodySystem& body = problem.bodies[t];
    tissue.elasticity().update(x[t], *elastic_states[t], forces[t]);
    body.stiffness_scale = dt * (dt + tissue.damping().stiffness_s);
    body.damping_scale = body.D != nullptr ? dt : 0.0;
    body.mass = (1.0 + dt * tissue.damping().mass_per_s) * tissue.nodeMasses();
    body.b = solution.v[t] * tissue.nodeMasses().asDiagonal();
    body.b += dt * forces[t];
    body.b += (dt * scene.gravity_m_per_s2) * tissue.nodeMasses().transpose();
    for (int i = 0; i < tissue.nodeCount(); ++i) {
      if (tissue.fixed()[i]) body.b.col(i).setZero();
    }
  }
}

void Simulator::Implementation::assembleContacts(double dt) {
  memory.recall(contacts, motion.longestTravel() + mean_edge, answers);
  problem.contacts.resize(contacts.size());
  solution.impulses.resize(contacts.size());
  solution.states.resize(contacts.size());
  taken_back.resize(contacts.size());
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

void Simulator::Implementation::moveTissues(double dt) {
  bool finite = true;
  for (const NodalVectors& v : solution.v) finite = finite && v.allFinite();
  for (const Vector3& impulse : solution.impulses) finite = finite && impulse.allFinite();
  if (finite) {
    for (std::size_t t = 0; t < tissues.size(); ++t) x[t] += dt * solution.v[t];
    return;
  }
  report.discarded = true;
  report.stop = StopReason::kIterations;
  report.residuals = Residuals();
  makeElasticStates();  // what is not finite may have got into tangents and factors
  for (NodalVectors& v : solution.v) v.setZero();
  for (Vector3& impulse : solution.impulses) impulse.setZero();
  std::fill(solution.states.begin(), solution.states.end(), ContactState::kOpen);
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

/// Tangential way of a contact in this step, m, world frame; of a static one with what earlier steps have left.
Vector3 Simulator::Implementation::slipOf(std::size_t c, double dt) const {
  const Contact& contact = contacts[c];
  const Vector2 true_velocity = relativeVelocity(problem.contacts[c], solution.v).tail<2>() - taken_back[c];
  Vector3 slip = dt * (contact.R_WC.rightCols<2>() * true_velocity);
  if (solution.states[c] != ContactState::kStatic) return slip;
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

Simulator::Simulator(const Scene& scene, const SceneEnvironment& environment)
    : implementation_(std::make_unique<Implementation>(scene, environment)) {}
Simulator::~Simulator() = default;
Simulator::Simulator(Simulator&&) noexcept = default;
Simulator& Simulator::operator=(Simulator&&) noexcept = default;

const Scene& Simulator::scene() const { return implementation_->scene; }
const std::vector<Instrument>& Simulator::instruments() const { return implementation_->instruments; }
const std::vector<Tissue>& Simulator::tissues() const { return implementation_->tissues; }

void Simulator::reset() { implementation_->reset(); }

void Simulator::placeInstrument(int instrument, const VectorX& joint_positions) {
  requireJointPositions(instrument, joint_positions);
  implementation_->motion.place(instrument, joint_positions);
}

void Simulator::requireJointPositions(int instrument, const VectorX& joint_positions) const {
  const Instrument& target = implementation_->instruments.at(instrument);
  const std::vector<IndependentJoint>& joints = target.model().joints();
  if (joint_positions.size() != static_cast<Eigen::Index>(joints.size())) {
    throwBadValue("instrument '" + target.name() + "': number of joint positions",
                  static_cast<double>(joint_positions.size()), "", std::to_string(joints.size()));
  }
  for (std::size_t j = 0; j < joints.size(); ++j) {
    requireFinite("instrument '" + target.name() + "': position of joint '" + joints[j].name + "'",
                  joint_positions[static_cast<Eigen::Index>(j)], "rad or m");
  }
}

void Simulator::advance(double duration_s, const std::vector<VectorX>& joint_positions) {
  Implementation& all = *implementation_;
  requirePositive("duration", duration_s, "s");
  if (joint_positions.size() != all.instruments.size()) {
    throwBadValue("number of joint-position vectors", static_cast<double>(joint_positions.size()), "",
                  std::to_string(all.instruments.size()));
  }
  for (std::size_t i = 0; i < joint_positions.size(); ++i) {
    requireJointPositions(static_cast<int>(i), joint_positions[i]);
  }
  all.report.discarded = false;
  all.report.substeps = all.motion.begin(duration_s, all.scene.step.max_step_s, joint_positions);
  all.report.jumped = all.motion.jumped();
  const double dt = duration_s / all.report.substeps;
  for (int k = 1; k <= all.report.substeps; ++k) {
    all.motion.moveTo(static_cast<double>(k) / all.report.substeps);
    all.step(dt);
  }
  all.sumWrenches();
}

Wrench Simulator::wrench(int instrument) const { return implementation_->wrenches.at(instrument); }
const VectorX& Simulator::jointPositions(int instrument) const { return implementation_->motion.positions(instrument); }
const std::vector<Pose>& Simulator::linkPoses(int instrument) const {
  return implementation_->motion.startPoses().at(instrument);
}
const NodalVectors& Simulator::positions(int tissue) const { return implementation_->x.at(tissue); }
const NodalVectors& Simulator::velocities(int tissue) const { return implementation_->solution.v.at(tissue); }
const std::vector<SolvedContact>& Simulator::contacts() const { return implementation_->solved; }
const StepReport& Simulator::report() const { return implementation_->report; }
long Simulator::stepCount() const { return implementation_->step_count; }
const ContactProblem& Simulator::lastProblem() const { return implementation_->problem; }
const ContactSolution& Simulator::lastSolution() const { return implementation_->solution; }
void Simulator::setStepObserver(std::function<void()> observer) { implementation_->observer = std::move(observer); }
ContactSolver::Memory Simulator::solverMemory() const { return implementation_->solver->memory(); }

}  // namespace tissue_contact
