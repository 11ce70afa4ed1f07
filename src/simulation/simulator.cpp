#include "tissue_contact/simulation/simulator.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

#include "instrument/joint_bounds.h"
#include "simulation/advisor.h"
#include "simulation/build_scene.h"
#include "simulation/force_error_estimate.h"
#include "simulation/simulator_implementation.h"
#include "tissue_contact/core/check.h"
#include "tissue_contact/core/entry_error.h"
#include "tissue_contact/tissue/make_elasticity.h"

namespace tissue_contact {
namespace {

/// With the version of what follows it.
constexpr const char* kStateTitle = "tissue_contact simulation 9";

void requireSizes(const std::vector<VectorX>& joint_positions, const std::vector<VectorX>& joint_velocities) {
  const auto same_size = [](const VectorX& a, const VectorX& b) { return a.size() == b.size(); };
  if (!std::equal(joint_positions.begin(), joint_positions.end(), joint_velocities.begin(), joint_velocities.end(),
                  same_size)) {
    throw std::invalid_argument("joint velocities must be as many as joint positions, for each instrument");
  }
}

NodalVectors handOver(NodalVectors& values) {
  NodalVectors copy = values;
  copy.swap(values);
  return copy;
}

}  // namespace

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
std::vector<Advice> Simulator::advice() const {
  const Implementation& all = *implementation_;
  const HalfExtents shapes = all.touched_places.halfExtents();
  std::vector<std::vector<Advice>> meshes(all.tissues.size());
  for (std::size_t t = 0; t < meshes.size(); ++t) {
    const TissueDescription& tissue = scene().tissues[t];
    if (const auto doubt = sizeDoubt(tissue, all.tissues[t].restPositions(), shapes)) meshes[t].push_back(*doubt);
    if (const auto doubt = unitDoubt(tissue)) meshes[t].push_back(*doubt);
    if (const auto doubt = stepDoubt(scene(), tissue)) meshes[t].push_back(*doubt);
    if (const auto doubt = supportDoubt(scene(), t, all.tissues)) meshes[t].push_back(*doubt);
    if (const auto doubt = springDoubt(tissue, all.tissues[t])) meshes[t].push_back(*doubt);
    if (const auto doubt = inflationDoubt(tissue, all.tissues[t])) meshes[t].push_back(*doubt);
    if (!isContinuum(tissue.material.model)) continue;
    if (const auto doubt = bendingDoubt(scene(), t, all.tissues)) meshes[t].push_back(*doubt);
    if (!all.refinements[t]) {
      if (const auto doubt = heldDoubt(tissue, all.tissues[t])) meshes[t].push_back(*doubt);
      meshes[t].push_back(meshLine(tissue, shortSurfaceEdge(all.tissues[t]), shapes));
      continue;
    }
    const std::vector<double> cells_m = all.touched_places.cellsOn(static_cast<int>(t));
    meshes[t].push_back(refinementLine(tissue, *all.refinements[t], cells_m, shapes));
  }
  return adviceLines(scene(), all.folds, meshes);
}

void Simulator::reset() { implementation_->reset(); }

void Simulator::carry(StateArchive& archive) {
  if (!archive.isReading())
    forceErrors();  // and residuals: of the numbers of the step before, and of the solver that forgets
  implementation_->carry(archive);
}

std::string Simulator::saveState() {
  StateArchive archive(kStateTitle);
  carry(archive);
  return archive.finish();
}

void Simulator::restoreState(const std::string& state) {
  restoreOrPutBack(
      kStateTitle, state, [this] { return saveState(); }, [this](StateArchive& archive) { carry(archive); },
      [this] { reset(); });
}

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
    if (isJointPosition(position)) continue;  // the message would allocate
    throwBadValue("instrument '" + target.name() + "': position of joint '" + joints[j].name + "'", position, "",
                  kJointPositionRange);
  }
}

void Simulator::advance(double duration_s, const std::vector<VectorX>& joint_positions, const AdvanceLimits& limits,
                        const JointVelocities* joint_velocities) {
  Implementation& all = *implementation_;
  requirePositive("duration", duration_s, "s");
  if (joint_positions.size() != all.instruments.size()) {
    throwBadValue("number of joint-position vectors", static_cast<double>(joint_positions.size()), "",
                  std::to_string(all.instruments.size()));
  }
  for (std::size_t i = 0; i < joint_positions.size(); ++i) {
    requireJointPositions(static_cast<int>(i), joint_positions[i]);
  }
  if (joint_velocities != nullptr) {
    requireSizes(joint_positions, joint_velocities->start);
    requireSizes(joint_positions, joint_velocities->end);
  }
  const double longest_s = limits.longest_step_s > 0.0 ? limits.longest_step_s : all.scene.step.max_step_s;
  if (!(duration_s <= InstrumentMotion::kMostSteps * longest_s)) {
    throwBadValue("duration", duration_s, "s", "at most a billion steps of " + std::to_string(longest_s) + " s");
  }
  StepReport& report = all.report;
  report.discarded = false;
  report.interrupted = false;
  const int steps = all.motion.begin(duration_s, longest_s, joint_positions, limits.most_steps, joint_velocities);
  report.jumped = all.motion.jumped();
  const double dt = duration_s / steps;
  for (report.substeps = 0; report.substeps < steps && !report.interrupted;) {
    all.motion.moveTo(static_cast<double>(++report.substeps) / steps);
    all.compliant_joints.give(dt, all.motion);
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
  implementation_->deadline_s = clock_s;
  implementation_->prompt_s = prompt_s;
}

Wrench Simulator::wrench(int instrument) const { return implementation_->wrenches.at(instrument); }
const VectorX& Simulator::jointPositions(int instrument) const { return implementation_->motion.positions(instrument); }
const VectorX& Simulator::jointDeflections(int instrument) const {
  return implementation_->motion.deflections(instrument);
}
const std::vector<Pose>& Simulator::linkPoses(int instrument) const {
  return implementation_->motion.startPoses().at(instrument);
}
const TriangleMesh* Simulator::actingSurface(int instrument, int contact_link, int shape) const {
  return implementation_->detector.actingSurface(instrument, contact_link, shape);
}
const NodalVectors& Simulator::positions(int tissue) const { return implementation_->x.at(tissue); }
const NodalVectors& Simulator::velocities(int tissue) const { return implementation_->solution.v.at(tissue); }
NodalVectors Simulator::handOverPositions(int tissue) { return handOver(implementation_->x.at(tissue)); }
NodalVectors Simulator::handOverVelocities(int tissue) { return handOver(implementation_->solution.v.at(tissue)); }
const std::vector<SolvedContact>& Simulator::contacts() const { return implementation_->contacts.solved(); }
const StepReport& Simulator::report() const { return implementation_->report; }
const Residuals& Simulator::residuals() const {
  Implementation& all = *implementation_;
  if (!all.residuals) all.residuals = computeResiduals(all.problem, all.solution, all.residual_scratch);
  return *all.residuals;
}
const std::vector<ForceErrorEstimate>& Simulator::forceErrors() const {
  Implementation& all = *implementation_;
  if (all.force_errors) return *all.force_errors;
  const double defect_n_s = residuals().net_defect_n_s;
  const bool cut_short = all.report.stop != StopReason::kTolerance && !all.problem.contacts.empty();
  const double lacking_n_s = cut_short ? all.solver->impulseLacking(all.problem, all.solution) : 0.0;
  const double missing_n_s = std::max(defect_n_s, lacking_n_s);  // each tells some of the other
  const double unbalanced_n =
      missing_n_s == 0.0 ? 0.0 : missing_n_s / all.problem.dt_s;  // no step yet: no length of it
  std::vector<MomentumRate> momentum_rates;
  for (const MovingTissue& tissue : all.moving) momentum_rates.push_back(tissue.momentumRate());
  all.force_errors = estimateForceErrors(all.scene, all.tissues, all.x, all.contacts.solved(), all.touched_places,
                                         all.instruments.size(), momentum_rates, unbalanced_n);
  return *all.force_errors;
}
int Simulator::meshRevision(int tissue) const {
  const auto& refinement = implementation_->refinements.at(tissue);
  return refinement ? refinement->revision() : 0;
}
MeshMoves Simulator::meshMoves(int tissue) const {
  const auto& follower = implementation_->followers.at(tissue);
  return follower ? follower->moves() : MeshMoves();
}
long Simulator::stepCount() const { return implementation_->step_count; }
void Simulator::lowerClosestApproach(Approach& closest) {
  implementation_->detector.lowerClosestApproach(implementation_->x, implementation_->motion.startPoses(), closest);
}
const ContactProblem& Simulator::lastProblem() const { return implementation_->problem; }
const ContactSolution& Simulator::lastSolution() const { return implementation_->solution; }
void Simulator::setStepObserver(std::function<void()> observer) { implementation_->observer = std::move(observer); }

}  // namespace tissue_contact
