#include "simulation/simulator_implementation.h"

#include <algorithm>
#include <cmath>
#include <exception>
#include <optional>

#include "simulation/build_scene.h"
#include "simulation/free_body.h"
#include "tissue_contact/baselines/make_contact_solver.h"
#include "tissue_contact/core/check.h"
#include "tissue_contact/core/entry_error.h"
#include "tissue_contact/simulation/touched_point.h"

namespace tissue_contact {
namespace {

/// A mesh is refined before an instrument reaches it that moves on as fast for so many steps.
constexpr double kStepsAhead = 4.0;

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

Simulator::Implementation::Implementation(const Scene& description, const SceneEnvironment& environment)
    : scene(description),
      clock(environment.clock),
      instruments(buildInstruments(scene, environment)),
      tissues(buildTissues(scene, environment, refinements)),
      friction(scene, instruments, tissues),
      edges(tissues),
      motion(instruments),
      compliant_joints(instruments, tissues, motion),
      x(tissues.size()),
      margins(edges, tissues.size(), buildTissuePairs(scene)),
      detector(instruments, shareSurfaces(surfacesOf(tissues), restPositionsOf(tissues)), environment.meshes),
      contacts(tissues, motion, friction, edges),
      solver(atEntry("solver", [&] { return makeContactSolver(scene.solver, clock); })),
      touched_places(scene, instruments),
      wrenches(instruments.size()),
      load_watch(scene, tissues) {
  requireMethodForLaws(scene);
  contacts.setMaterials(scene.tissues);
  atEntry("step.max_step_s", [&] { requirePositive("step.max_step_s", scene.step.max_step_s, "s"); });
  atEntry("advisor.sleep_error", [&] { requireNonNegative("advisor.sleep_error", scene.advisor.sleep_error); });
  if (!scene.tissue_pairs.empty()) {
    const std::vector<TouchingTissues> pairs = buildTissuePairs(scene);
    pair_detector.emplace(pairs, detector.surfaces());
    if (scene.advisor.skip_folds) folds = FoldWatch(pairs, tissues);
  }
  for (std::size_t t = 0; t < tissues.size(); ++t) {
    const std::vector<double> cells_m = touched_places.cellsOn(static_cast<int>(t));
    approach_m.push_back(refinements[t] && !cells_m.empty() ? refinements[t]->cells().reach(cells_m.back()) : -1.0);
  }
  near_m.resize(tissues.size());
  solution.v.resize(tissues.size());
  for (const Tissue& tissue : tissues) solution.slow_changes.push_back(NodalVectors::Zero(3, tissue.nodeCount()));
  problem.bodies.resize(tissues.size());
  contact_work_j.reserve(tissues.size());
  for (std::size_t t = 0; t < tissues.size(); ++t) {
    moving.emplace_back(scene, scene.tissues[t].material.model, tissues[t], x[t], solution.v[t], problem.bodies[t]);
  }
  followers.resize(tissues.size());
  for (std::size_t t = 0; t < tissues.size(); ++t) {
    if (!refinements[t]) continue;
    if (!worker) worker = std::make_unique<BackgroundWorker>();
    followers[t] = std::make_unique<MeshFollower>(usersOf(static_cast<int>(t)), *refinements[t], *worker);
  }
}

void Simulator::Implementation::reset() {
  motion.reset();
  contacts.clear();
  for (std::size_t t = 0; t < tissues.size(); ++t) {
    if (!refinements[t]) continue;
    followers[t]->drop();
    if (refinements[t]->reset()) restartMesh(static_cast<int>(t));
  }
  for (MovingTissue& tissue : moving) tissue.reset();
  problem.contacts.clear();
  solution.impulses.clear();
  solution.states.clear();
  for (NodalVectors& change : solution.slow_changes) change.setZero();
  solver->reset();
  wrenches.assign(instruments.size(), Wrench());
  force_errors.reset();
  report = StepReport();
  residuals = Residuals();
  step_count = 0;
  last_dt = 0.0;
}

/// One implicit step: the rooms in order.
void Simulator::Implementation::step(double dt) {
  residuals.reset();
  restTissues();
  if (retuned) retune();
  refineTissues(dt);
  detectContacts(dt);
  wakeTouched();
  assemble(dt);
  solve(dt);
  moveTissues(dt);
  motion.finishStep();
  ++step_count;
  recordContacts();
  compliant_joints.load(problem, solution, contacts.solved(), motion);
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
void Simulator::Implementation::refineTissues(double dt) {
  if (!worker) return;
  const double travel_m = motion.longestTravel();
  const double touches_m = kStepsAhead * travel_m;
  const auto ahead_m = [&](std::size_t t) { return touches_m + MeshFollower::ahead(travel_m, dt, approach_m[t]); };
  for (std::size_t t = 0; t < tissues.size(); ++t) near_m[t] = approach_m[t] < 0.0 ? -1.0 : approach_m[t] + ahead_m(t);
  detector.findNear(x, motion.startPoses(), near_m, near);
  bool any = false;
  std::exception_ptr error;  // the meshes of the others are theirs nevertheless
  for (std::size_t t = 0; t < tissues.size(); ++t) {
    if (!followers[t]) continue;
    try {
      any |= refineTissue(static_cast<int>(t), {motion, dt, ahead_m(t), touches_m});
    } catch (...) {
      if (!error) error = std::current_exception();
    }
  }
  if (any) {
    contacts.finishRenumbering();
    solver->reset();
  }
  if (!error) return;
  if (any) {  // what was solved last belongs to the meshes before
    problem.contacts.clear();
    solution.impulses.assign(contacts.solved().size(), Vector3::Zero());
    solution.states.clear();
    force_errors.reset();
    residuals = Residuals();
  }
  std::rethrow_exception(error);
}

/// @return whether the mesh of that tissue has changed.
bool Simulator::Implementation::refineTissue(int tissue, const TouchedPlaces::Approaching& approaching) {
  touched_places.begin(tissue, contacts.solved(), tissues[tissue].restPositions(), last_dt);
  touched_places.addNear(near, refinements[tissue]->cells(), approaching, x[tissue], tissues[tissue].restPositions());
  ComingMesh* const coming = followers[tissue]->follow(touched_places.places(), x[tissue], last_dt);
  if (coming != nullptr) changeMesh(tissue, *coming);
  return coming != nullptr;
}

void Simulator::Implementation::changeMesh(int tissue, ComingMesh& coming) {
  const NodeTransfer& transfer = *coming.next.transfer;
  std::optional<FreeMotion> had;
  if (moving[tissue].isFree()) had = freeMotionOf(tissues[tissue].nodeMasses(), x[tissue], solution.v[tissue]);
  x[tissue] = transfer.carried(x[tissue]);
  solution.v[tissue] = transfer.carried(solution.v[tissue]);
  solution.slow_changes[tissue] = transfer.carried(solution.slow_changes[tissue]);
  takeMesh(tissue, coming, transfer.to_new);
  if (had && moving[tissue].isFree()) keepMomentum(*had, tissues[tissue].nodeMasses(), x[tissue], solution.v[tissue]);
}

/// Goes on with all that was made from another mesh of this tissue; x and v are those of its nodes already. Members that refer to each
/// other keep their places.
/// @param to_new see StepContacts::renumber().
void Simulator::Implementation::takeMesh(int tissue, ComingMesh& coming, const std::vector<int>& to_new) {
  if (!coming.elastic_state) makeStateAt(x[tissue], coming);
  const double edge_m = coming.edges.mean;
  if (!to_new.empty()) contacts.noteCells(tissue);
  std::swap(tissues[tissue], *coming.tissue);
  friction.swapSurface(tissue, coming.friction_triangles);
  edges.swapSurface(tissue, coming.edges);
  load_watch.swapMesh(tissue, coming.loads);
  detector.swapSurface(*coming.surface);
  folds.swapMesh(tissue, coming.fold);
  contacts.renumber(tissue, to_new, coming.pressure_triangles);
  moving[tissue].changeMesh(coming.elastic_state, edge_m);
}

/// Undeformed and at rest, with the mesh that the refinement has now.
void Simulator::Implementation::restartMesh(int tissue) {
  ComingMesh coming;
  makeParts(refinements[tissue]->tissue(), usersOf(tissue), coming);
  x[tissue] = coming.tissue->restPositions();
  solution.v[tissue].setZero(3, coming.tissue->nodeCount());
  solution.slow_changes[tissue].setZero(3, coming.tissue->nodeCount());
  takeMesh(tissue, coming, {});
}

MeshUsers Simulator::Implementation::usersOf(int tissue) const {
  return {tissue, scene.tissues[tissue].material.model, friction.dependsOnPressure(), &folds};
}

void Simulator::Implementation::detectContacts(double dt) {
  margins.begin(solution.v, scene.gravity_m_per_s2, dt, motion.longestTravel());
  detector.detect(x, motion.startPoses(), margins.ofTissues(), found);
  report.pinched_contacts = detector.pinchedContacts();
  if (pair_detector) {
    contacts.keysBetweenTissues(known);
    pair_detector->detect(x, margins.ofPairs(), folds.apart(x, margins.ofTissues()), known, found);
    std::sort(found.begin(), found.end(), [](const Contact& a, const Contact& b) { return a.key < b.key; });
  }
  contacts.begin(detector, x, margins, found);
  contacts.slideOn(detector, solution.v, dt);
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
  const auto is_possible = [dt](const MovingTissue& tissue) { return tissue.isPossible(dt); };
  if (std::all_of(moving.begin(), moving.end(), is_possible) &&
      std::all_of(solution.impulses.begin(), solution.impulses.end(), is_finite)) {
    const bool was_cut = report.stop != StopReason::kTolerance;
    if (was_cut) {
      for (MovingTissue& tissue : moving) tissue.keepElements(dt);
    }
    findContactWork();
    for (std::size_t t = 0; t < moving.size(); ++t) moving[t].move(dt, contact_work_j[t], was_cut, !is_pressed[t]);
    return;
  }
  report.discarded = true;
  report.stop = StopReason::kIterations;
  residuals = Residuals();
  report.sleeping_nodes = 0;
  report.held_force_n = 0.0;
  for (MovingTissue& tissue : moving) tissue.stop();
  for (NodalVectors& change : solution.slow_changes) change.setZero();
  solver->reset();
  std::fill(solution.impulses.begin(), solution.impulses.end(), Vector3(0.0, 0.0, 0.0));
  std::fill(solution.states.begin(), solution.states.end(), ContactState::kOpen);
}

/// Of the step's contacts on each tissue.
void Simulator::Implementation::findContactWork() {
  contact_work_j.assign(moving.size(), 0.0);
  is_pressed.assign(moving.size(), false);
  for (std::size_t c = 0; c < problem.contacts.size(); ++c) {
    const ContactRow& row = problem.contacts[c];
    const Vector3 impulse_W = row.R_WC * solution.impulses[c];
    for (int a = 0; a < row.node_count; ++a) {
      const RowNode& at = row.nodes[a];
      if (!impulse_W.isZero(0.0)) is_pressed[at.body] = true;
      contact_work_j[at.body] += at.weight * impulse_W.dot(solution.v[at.body].col(at.node));
    }
  }
}

void Simulator::Implementation::recordContacts() {
  contacts.record(x, problem, solution);
  report.open_contacts = contacts.count(ContactState::kOpen);
  report.static_contacts = contacts.count(ContactState::kStatic);
  report.kinetic_contacts = contacts.count(ContactState::kKinetic);
}

void Simulator::Implementation::sumWrenches() {
  wrenches.assign(instruments.size(), Wrench());
  force_errors.reset();
  for (const SolvedContact& solved : contacts.solved()) {
    const ContactKey& key = solved.contact.key;
    if (key.instrument < 0) continue;
    const Pose& X_WTip = motion.startPoses()[key.instrument][instruments[key.instrument].tipLink()];
    const Vector3 force_W = -solved.force_on_tissue_n;
    Wrench& wrench = wrenches[key.instrument];
    wrench.force += X_WTip.linear().transpose() * force_W;
    const Vector3 arm_W = touchedPoint(solved.contact, tissues) - X_WTip.translation();
    wrench.torque += X_WTip.linear().transpose() * arm_W.cross(force_W);
  }
}

CoarseCells Simulator::Implementation::coarsestCells() const {
  CoarseCells coarsest;
  for (std::size_t t = 0; t < refinements.size(); ++t) {
    if (!followers[t] || !(followers[t]->coarsening() > coarsest.factor)) continue;
    coarsest = {static_cast<int>(t), followers[t]->coarsening()};
  }
  return coarsest;
}

}  // namespace tissue_contact
