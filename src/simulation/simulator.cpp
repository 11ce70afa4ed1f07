#include "tissue_contact/simulation/simulator.h"

#include <algorithm>
#include <cmath>
#include <deque>
#include <optional>
#include <stdexcept>

#include "simulation/advisor.h"
#include "simulation/build_scene.h"
#include "simulation/detection_margins.h"
#include "simulation/fold_watch.h"
#include "simulation/friction_table.h"
#include "simulation/instrument_motion.h"
#include "simulation/load_watch.h"
#include "simulation/moving_tissue.h"
#include "simulation/step_contacts.h"
#include "simulation/touched_places.h"
#include "tissue_contact/baselines/make_contact_solver.h"
#include "tissue_contact/contact/tissue_pair_detector.h"
#include "tissue_contact/core/check.h"
#include "tissue_contact/core/entry_error.h"

namespace tissue_contact {
namespace {

/// A mesh is refined before an instrument reaches it that moves on as fast for so many steps.
constexpr double kStepsAhead = 4.0;

TissueSurface surfaceOf(const Tissue& tissue) { return {tissue.surface(), tissue.fixed(), tissue.thickness()}; }

std::vector<TissueSurface> surfacesOf(const std::vector<Tissue>& tissues) {
  std::vector<TissueSurface> surfaces;
  surfaces.reserve(tissues.size());
  for (const Tissue& tissue : tissues) surfaces.push_back(surfaceOf(tissue));
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
  Implementation(const Implementation&) = delete;  // members refer to each other
  Implementation& operator=(const Implementation&) = delete;
  void reset();
  void step(double dt);
  void restTissues();
  void refineTissues();
  void changeMesh(int tissue, const NodeTransfer& transfer);
  void takeMesh(int tissue, const std::vector<int>& to_new);
  void detectContacts(double dt);
  void wakeTouched();
  void assemble(double dt);
  void solve(double dt);
  bool wakeHeld(double dt, int repeats);
  void moveTissues(double dt);
  void recordContacts();
  void sumWrenches();
  CoarseCells coarsestCells() const;

  const Scene scene;
  const std::vector<Instrument> instruments;
  std::vector<std::unique_ptr<TissueRefinement>> refinements;  ///< per tissue; null: its mesh never changes
  std::vector<Tissue> tissues;
  FrictionTable friction;
  SurfaceEdges edges;

  InstrumentMotion motion;
  std::vector<NodalVectors> x;  ///< per tissue, m
  ContactProblem problem;
  ContactSolution solution;         ///< v is the tissues' velocity
  std::deque<MovingTissue> moving;  ///< per tissue, each with its own of the three above; they never change their place
  DetectionMargins margins;
  ContactDetector detector;
  std::optional<TissuePairDetector> pair_detector;  ///< only where tissues touch each other
  FoldWatch folds;
  std::vector<Contact> found;  ///< scratch: by the detectors
  StepContacts contacts;
  std::unique_ptr<ContactSolver> solver;
  std::vector<int> touched_nodes;  ///< scratch
  TouchedPlaces touched_places;
  std::vector<double>
      approach_m;  ///< per tissue: how near a resting shape must be for the mesh to be refined; < 0: it never is
  std::vector<double> near_m;    ///< scratch: the same in this step
  std::vector<NearPlace> near;   ///< scratch
  std::vector<Wrench> wrenches;  ///< per instrument
  LoadWatch load_watch;
  StepReport report;
  std::optional<Residuals> residuals = Residuals();  ///< none: nobody has asked since the step
  std::vector<NodalVectors> residual_scratch;
  long step_count = 0;
  double last_dt = 0.0;  ///< of the step before, s
  std::function<void()> observer;
};

Simulator::Implementation::Implementation(const Scene& description, const SceneEnvironment& environment)
    : scene(description),
      instruments(buildInstruments(scene, environment)),
      tissues(buildTissues(scene, environment, refinements)),
      friction(scene, instruments, tissues),
      edges(tissues),
      motion(instruments),
      x(tissues.size()),
      margins(edges, tissues.size(), buildTissuePairs(scene)),
      detector(instruments, shareSurfaces(surfacesOf(tissues), restPositionsOf(tissues)), environment.meshes),
      contacts(tissues, motion, friction, edges),
      solver(atEntry("solver", [&] { return makeContactSolver(scene.solver, environment.clock); })),
      touched_places(scene, instruments),
      wrenches(instruments.size()),
      load_watch(scene, tissues) {
  requireMethodForLaws(scene);
  atEntry("step.max_step_s", [&] { requirePositive("step.max_step_s", scene.step.max_step_s, "s"); });
  atEntry("advisor.sleep_error", [&] { requireNonNegative("advisor.sleep_error", scene.advisor.sleep_error); });
  if (!scene.tissue_pairs.empty()) {
    const std::vector<TouchingTissues> pairs = buildTissuePairs(scene);
    pair_detector.emplace(pairs, detector.surfaces());
    if (scene.advisor.skip_folds) folds = FoldWatch(pairs, tissues);
  }
  for (std::size_t t = 0; t < tissues.size(); ++t) {
    const std::vector<double> cells_m = touched_places.cellsOn(static_cast<int>(t));
    approach_m.push_back(refinements[t] && !cells_m.empty() ? refinements[t]->reach(cells_m.back()) : -1.0);
  }
  near_m.resize(tissues.size());
  solution.v.resize(tissues.size());
  problem.bodies.resize(tissues.size());
  for (std::size_t t = 0; t < tissues.size(); ++t) {
    moving.emplace_back(scene, tissues[t], x[t], solution.v[t], problem.bodies[t]);
  }
}

void Simulator::Implementation::reset() {
  motion.reset();
  contacts.clear();
  for (std::size_t t = 0; t < tissues.size(); ++t) {
    if (!refinements[t] || !refinements[t]->reset()) continue;
    takeMesh(static_cast<int>(t), {});
    x[t] = tissues[t].restPositions();
    solution.v[t].setZero(3, tissues[t].nodeCount());
    moving[t].changeMesh();
  }
  for (MovingTissue& tissue : moving) tissue.reset();
  problem.contacts.clear();
  solution.impulses.clear();
  solution.states.clear();
  solver->reset();
  wrenches.assign(instruments.size(), Wrench());
  report = StepReport();
  residuals = Residuals();
  step_count = 0;
  last_dt = 0.0;
}

/// One implicit step: the rooms in order.
void Simulator::Implementation::step(double dt) {
  residuals.reset();
  restTissues();
  refineTissues();
  detectContacts(dt);
  wakeTouched();
  assemble(dt);
  solve(dt);
  moveTissues(dt);
  motion.finishStep();
  ++step_count;
  recordContacts();
  last_dt = dt;
  if (observer) observer();
}

/// Lets tissues sleep on what the step before has left.
void Simulator::Implementation::restTissues() {
  if (!(last_dt > 0.0)) return;
  for (std::size_t t = 0; t < moving.size(); ++t) {
    if (!moving[t].isTimeToSleep(last_dt)) continue;
    const int tissue = static_cast<int>(t);
    contacts.touchedNodes(tissue, touched_nodes);
    moving[t].fallAsleep(contacts.weakestNetForce(tissue, solution.impulses, last_dt), touched_nodes);
  }
}

/// Lets the meshes follow what touched tissues in the step before, or is near to them now.
void Simulator::Implementation::refineTissues() {
  if (std::none_of(refinements.begin(), refinements.end(), [](const auto& one) { return one != nullptr; })) return;
  for (std::size_t t = 0; t < tissues.size(); ++t) {
    near_m[t] = approach_m[t] < 0.0 ? -1.0 : approach_m[t] + kStepsAhead * motion.longestTravel();
  }
  detector.findNear(x, motion.startPoses(), near_m, near);
  bool any = false;
  for (std::size_t t = 0; t < tissues.size(); ++t) {
    if (!refinements[t]) continue;
    const int tissue = static_cast<int>(t);
    touched_places.begin(tissue, contacts.solved(), tissues[t].restPositions());
    touched_places.addNear(near, *refinements[t], kStepsAhead * motion.longestTravel(), tissues[t].restPositions());
    const std::optional<NodeTransfer> transfer = refinements[t]->follow(touched_places.places());
    if (!transfer) continue;
    changeMesh(tissue, *transfer);
    any = true;
  }
  if (!any) return;
  contacts.finishRenumbering();
  solver->reset();
}

void Simulator::Implementation::changeMesh(int tissue, const NodeTransfer& transfer) {
  takeMesh(tissue, transfer.to_new);
  x[tissue] = transfer.carried(x[tissue]);
  solution.v[tissue] = transfer.carried(solution.v[tissue]);
  moving[tissue].changeMesh();
}

/// Makes again what has been made from the mesh of this tissue. Members that refer to each other keep their places.
/// @param to_new see StepContacts::renumber().
void Simulator::Implementation::takeMesh(int tissue, const std::vector<int>& to_new) {
  tissues[tissue] = refinements[tissue]->tissue();
  const Tissue& now = tissues[tissue];
  friction.setSurface(tissue, now);
  edges.setSurface(tissue, now);
  load_watch.setMesh(tissue, now);
  detector.setSurface(tissue, surfaceOf(now), now.restPositions());
  folds.setMesh(tissue, now);
  contacts.renumber(tissue, to_new);
}

void Simulator::Implementation::detectContacts(double dt) {
  margins.begin(solution.v, scene.gravity_m_per_s2, dt, motion.longestTravel());
  detector.detect(x, motion.startPoses(), margins.ofTissues(), found);
  report.pinched_contacts = detector.pinchedContacts();
  if (pair_detector) {
    pair_detector->detect(x, margins.ofPairs(), folds.apart(x, margins.ofTissues()), found);
    std::sort(found.begin(), found.end(), [](const Contact& a, const Contact& b) { return a.key < b.key; });
  }
  contacts.begin(detector, x, margins, found);
}

/// Nodes that contacts act on wake before anything is computed with them.
void Simulator::Implementation::wakeTouched() {
  for (std::size_t t = 0; t < moving.size(); ++t) {
    if (moving[t].sleepers() == 0) continue;
    contacts.touchedNodes(static_cast<int>(t), touched_nodes);
    moving[t].wake(touched_nodes);
  }
}

void Simulator::Implementation::assemble(double dt) {
  problem.dt_s = dt;
  for (MovingTissue& tissue : moving) tissue.assemble(dt);
  contacts.assemble(x, dt, last_dt, problem.contacts, solution);
}

/// Solves the step, again where it shows that sleeping nodes must move.
void Simulator::Implementation::solve(double dt) {
  report.iterations = 0;
  for (int repeats = 0;; ++repeats) {
    const SolverReport solver_report = solver->solve(problem, solution);
    report.iterations += solver_report.iterations;
    report.stop = solver_report.stop;
    if (!wakeHeld(dt, repeats)) return;
  }
}

/// @return whether some nodes woke, with which the step is to be solved again.
bool Simulator::Implementation::wakeHeld(double dt, int repeats) {
  bool any = false;
  report.sleeping_nodes = 0;
  report.held_force_n = 0.0;
  for (std::size_t t = 0; t < moving.size(); ++t) {
    if (!moving[t].canSleep()) continue;
    const auto pressing_n = contacts.weakestNetForce(static_cast<int>(t), solution.impulses, dt);
    if (moving[t].wakeHeld(pressing_n, dt, repeats)) any = true;
    report.sleeping_nodes += moving[t].sleepers();
    report.held_force_n += moving[t].heldForce();
  }
  return any;
}

void Simulator::Implementation::moveTissues(double dt) {
  const auto is_finite = [](const Vector3& impulse) { return impulse.allFinite(); };
  if (std::all_of(moving.begin(), moving.end(), [](const MovingTissue& tissue) { return tissue.isFinite(); }) &&
      std::all_of(solution.impulses.begin(), solution.impulses.end(), is_finite)) {
    for (MovingTissue& tissue : moving) tissue.move(dt);
    return;
  }
  report.discarded = true;
  report.stop = StopReason::kIterations;
  residuals = Residuals();
  report.sleeping_nodes = 0;
  report.held_force_n = 0.0;
  for (MovingTissue& tissue : moving) tissue.stop();
  solver->reset();
  std::fill(solution.impulses.begin(), solution.impulses.end(), Vector3(0.0, 0.0, 0.0));
  std::fill(solution.states.begin(), solution.states.end(), ContactState::kOpen);
}

void Simulator::Implementation::recordContacts() {
  contacts.record(x, problem, solution);
  report.open_contacts = contacts.count(ContactState::kOpen);
  report.static_contacts = contacts.count(ContactState::kStatic);
  report.kinetic_contacts = contacts.count(ContactState::kKinetic);
}

void Simulator::Implementation::sumWrenches() {
  wrenches.assign(instruments.size(), Wrench());
  for (const SolvedContact& solved : contacts.solved()) {
    const ContactKey& key = solved.contact.key;
    if (key.instrument < 0) continue;
    const Pose& X_WTip = motion.startPoses()[key.instrument][instruments[key.instrument].tipLink()];
    const Vector3 force_W = -solved.force_on_tissue_n;
    Wrench& wrench = wrenches[key.instrument];
    wrench.force += X_WTip.linear().transpose() * force_W;
    wrench.torque += X_WTip.linear().transpose() * (solved.contact.p_WC - X_WTip.translation()).cross(force_W);
  }
}

CoarseCells Simulator::Implementation::coarsestCells() const {
  CoarseCells coarsest;
  for (std::size_t t = 0; t < refinements.size(); ++t) {
    if (!refinements[t] || !(refinements[t]->coarsening() > coarsest.factor)) continue;
    coarsest = {static_cast<int>(t), refinements[t]->coarsening()};
  }
  return coarsest;
}

std::unique_ptr<Simulator::Implementation> Simulator::build(const Scene& scene, const SceneEnvironment& environment) {
  try {
    return atEntry("", [&] { return std::make_unique<Implementation>(scene, environment); });
  } catch (const EntryError& error) {
    throw std::invalid_argument(placeOf(scene, error.entry()) + ": " + error.what());
  }
}

Simulator::Simulator(const Scene& scene, const SceneEnvironment& environment)
    : implementation_(build(scene, environment)) {}
Simulator::~Simulator() = default;
Simulator::Simulator(Simulator&&) noexcept = default;
Simulator& Simulator::operator=(Simulator&&) noexcept = default;

const Scene& Simulator::scene() const { return implementation_->scene; }
const std::vector<Instrument>& Simulator::instruments() const { return implementation_->instruments; }
const std::vector<Tissue>& Simulator::tissues() const { return implementation_->tissues; }
std::vector<std::string> Simulator::advice() const {
  const Implementation& all = *implementation_;
  std::vector<std::string> meshes(all.tissues.size());
  for (std::size_t t = 0; t < meshes.size(); ++t) {
    if (!all.refinements[t]) continue;
    const std::vector<double> cells_m = all.touched_places.cellsOn(static_cast<int>(t));
    const double cell_m = cells_m.empty() ? 0.0 : cells_m.front();
    meshes[t] = refinementLine(scene().tissues[t], cell_m, all.refinements[t]->reach(cell_m),
                               all.refinements[t]->nodesAtMost());
  }
  return adviceLines(scene(), all.folds, meshes);
}

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
    const double position = joint_positions[static_cast<Eigen::Index>(j)];
    if (std::isfinite(position)) continue;  // the message would allocate
    throwBadValue("instrument '" + target.name() + "': position of joint '" + joints[j].name + "'", position,
                  "rad or m", "finite");
  }
}

void Simulator::advance(double duration_s, const std::vector<VectorX>& joint_positions, const AdvanceLimits& limits) {
  Implementation& all = *implementation_;
  requirePositive("duration", duration_s, "s");
  if (joint_positions.size() != all.instruments.size()) {
    throwBadValue("number of joint-position vectors", static_cast<double>(joint_positions.size()), "",
                  std::to_string(all.instruments.size()));
  }
  for (std::size_t i = 0; i < joint_positions.size(); ++i) {
    requireJointPositions(static_cast<int>(i), joint_positions[i]);
  }
  const double longest_s = limits.longest_step_s > 0.0 ? limits.longest_step_s : all.scene.step.max_step_s;
  if (!(duration_s <= InstrumentMotion::kMostSteps * longest_s)) {
    throwBadValue("duration", duration_s, "s", "at most a billion steps of " + std::to_string(longest_s) + " s");
  }
  StepReport& report = all.report;
  report.discarded = false;
  report.interrupted = false;
  const int steps = all.motion.begin(duration_s, longest_s, joint_positions, limits.most_steps);
  report.jumped = all.motion.jumped();
  const double dt = duration_s / steps;
  for (report.substeps = 0; report.substeps < steps && !report.interrupted;) {
    all.motion.moveTo(static_cast<double>(++report.substeps) / steps);
    all.step(dt);
    report.interrupted = report.substeps < steps && limits.interrupted && limits.interrupted();
  }
  report.advanced_s = report.interrupted ? report.substeps * dt : duration_s;
  all.sumWrenches();
  all.load_watch.check(all.contacts.solved(), all.x, report.implausible_load, report.law_error);
  report.coarse_cells = all.coarsestCells();
}

void Simulator::setSolverDeadline(double clock_s, double prompt_s) {
  implementation_->solver->setDeadline(clock_s, prompt_s);
}

Wrench Simulator::wrench(int instrument) const { return implementation_->wrenches.at(instrument); }
const VectorX& Simulator::jointPositions(int instrument) const { return implementation_->motion.positions(instrument); }
const std::vector<Pose>& Simulator::linkPoses(int instrument) const {
  return implementation_->motion.startPoses().at(instrument);
}
const TriangleMesh* Simulator::actingSurface(int instrument, int contact_link, int shape) const {
  return implementation_->detector.actingSurface(instrument, contact_link, shape);
}
const NodalVectors& Simulator::positions(int tissue) const { return implementation_->x.at(tissue); }
const NodalVectors& Simulator::velocities(int tissue) const { return implementation_->solution.v.at(tissue); }
const std::vector<SolvedContact>& Simulator::contacts() const { return implementation_->contacts.solved(); }
const StepReport& Simulator::report() const { return implementation_->report; }
const Residuals& Simulator::residuals() const {
  Implementation& all = *implementation_;
  if (!all.residuals) all.residuals = computeResiduals(all.problem, all.solution, all.residual_scratch);
  return *all.residuals;
}
int Simulator::meshRevision(int tissue) const {
  const auto& refinement = implementation_->refinements.at(tissue);
  return refinement ? refinement->revision() : 0;
}
long Simulator::stepCount() const { return implementation_->step_count; }
void Simulator::lowerClosestApproach(Approach& closest) {
  implementation_->detector.lowerClosestApproach(implementation_->x, implementation_->motion.startPoses(), closest);
}
const ContactProblem& Simulator::lastProblem() const { return implementation_->problem; }
const ContactSolution& Simulator::lastSolution() const { return implementation_->solution; }
void Simulator::setStepObserver(std::function<void()> observer) { implementation_->observer = std::move(observer); }

}  // namespace tissue_contact
