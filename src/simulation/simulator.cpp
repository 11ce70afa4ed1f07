#include "tissue_contact/simulation/simulator.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "simulation/simulator_implementation.h"
#include "tissue_contact/core/check.h"
#include "tissue_contact/core/entry_error.h"
#include "tissue_contact/simulation/advisor.h"

namespace tissue_contact {
namespace {

/// Contacts are looked for this much beyond what present speeds can close in the step: speeds change within a step.
constexpr double kMarginFactor = 1.5;
constexpr double kMarginPerEdge = 0.01;

/// Tissues are looked for this many edges from each other at most: pairs of features grow with the square of it.
constexpr double kMostPairEdges = 2.0;

double sumOfEdges(const Tissue& tissue) {
  const NodalVectors& x = tissue.restPositions();
  double sum = 0.0;
  for (const Triangle& t : tissue.surface()) sum += (x.col(t[0]) - x.col(t[1])).norm();
  return sum;
}

double meanSurfaceEdge(const Tissue& tissue) {
  return sumOfEdges(tissue) / static_cast<double>(tissue.surface().size());
}

double meanSurfaceEdge(const std::vector<Tissue>& tissues) {
  double sum = 0.0;
  double count = 0.0;
  for (const Tissue& tissue : tissues) {
    sum += sumOfEdges(tissue);
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

Simulator::Implementation::Implementation(const Scene& description, const SceneEnvironment& environment)
    : scene(description),
      instruments(buildInstruments(scene, environment)),
      tissues(buildTissues(scene, environment)),
      friction(scene, instruments, tissues),
      mean_edge(meanSurfaceEdge(tissues)),
      motion(instruments),
      detector(instruments, surfacesOf(tissues), restPositionsOf(tissues), environment.meshes),
      solver(atEntry("solver", [&] { return makeContactSolver(scene.solver, environment.clock); })),
      load_watch(scene, tissues) {
  requireMethodForLaws(scene);
  atEntry("step.max_step_s", [&] { requirePositive("step.max_step_s", scene.step.max_step_s, "s"); });
  atEntry("advisor.sleep_error", [&] { requireNonNegative("advisor.sleep_error", scene.advisor.sleep_error); });
  if (!scene.tissue_pairs.empty()) {
    const std::vector<TouchingTissues> pairs = buildTissuePairs(scene);
    pair_detector.emplace(pairs, surfacesOf(tissues), restPositionsOf(tissues));
    if (scene.advisor.skip_folds) folds = FoldWatch(pairs, tissues);
  }
  elastic_states.resize(tissues.size());
  loads = restPositionsOf(tissues);  // for their sizes
  problem.bodies.resize(tissues.size());
  makeElasticStates();
  if (advisedSleep(scene)) {
    for (std::size_t t = 0; t < tissues.size(); ++t) {
      sleep.emplace_back(tissues[t].fixed(), problem.bodies[t], meanSurfaceEdge(tissues[t]),
                         advisedSleepByParts(scene));
    }
  }
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

/// One implicit step: the rooms in order.
void Simulator::Implementation::step(double dt) {
  restTissues(last_dt);
  detectContacts(dt);
  wakeTouched();
  assembleTissues(dt);
  assembleContacts(dt);
  solveContacts(dt);
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
  report.pinched_contacts = detector.pinchedContacts();
  if (pair_detector) {
    const double pair_margin = std::min(margin + kMarginFactor * tissue_travel, kMostPairEdges * mean_edge);
    pair_detector->detect(x, pair_margin, folds.apart(x, margin), contacts);
    std::sort(contacts.begin(), contacts.end(), [](const Contact& a, const Contact& b) { return a.key < b.key; });
  }
  memory.addKeptPoints(detector, x, motion.startPoses(), margin, contacts);
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
std::vector<std::string> Simulator::advice() const { return adviceLines(scene(), implementation_->folds); }

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
  StepReport& report = all.report;
  report.discarded = false;
  report.interrupted = false;
  const double longest_s = limits.longest_step_s > 0.0 ? limits.longest_step_s : all.scene.step.max_step_s;
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
  all.load_watch.look(all.solved, all.x, report.implausible_load);
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
const std::vector<SolvedContact>& Simulator::contacts() const { return implementation_->solved; }
const StepReport& Simulator::report() const { return implementation_->report; }
long Simulator::stepCount() const { return implementation_->step_count; }
void Simulator::lowerClosestApproach(Approach& closest) {
  implementation_->detector.lowerClosestApproach(implementation_->x, implementation_->motion.startPoses(), closest);
}
const ContactProblem& Simulator::lastProblem() const { return implementation_->problem; }
const ContactSolution& Simulator::lastSolution() const { return implementation_->solution; }
void Simulator::setStepObserver(std::function<void()> observer) { implementation_->observer = std::move(observer); }
ContactSolver::Memory Simulator::solverMemory() const { return implementation_->solver->memory(); }

}  // namespace tissue_contact
