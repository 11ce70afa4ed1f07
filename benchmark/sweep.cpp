#include "benchmark/sweep.h"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <limits>
#include <stdexcept>

#include "benchmark/peer.h"
#include "benchmark/truth_table.h"

namespace tissue_contact {
namespace {

using Cells = std::array<int, 3>;
using SizeKey = std::tuple<Cells, double, double>;  ///< mesh, step and the finest cells of a mesh that is refined

constexpr double kNone = std::numeric_limits<double>::quiet_NaN();

SizeKey sizeOf(const Settings& settings) { return {settings.cells, settings.dt_s, settings.refinement.cell_m}; }

bool sameSolver(const SolverDescription& a, const SolverDescription& b) {
  return a.method == b.method && a.relaxation == b.relaxation && a.iterations == b.iterations &&
         a.contact_passes == b.contact_passes && a.tolerance == b.tolerance;
}

/// Whether the relaxation makes a difference to a method.
bool relaxes(SolverMethod method) {
  return method != SolverMethod::kReference && method != SolverMethod::kCondensedLcp;
}

/// Of a refined mesh, roughly.
int nodesOf(const Settings& settings) {
  if (settings.refinement.nodes_at_most > 0) return settings.refinement.nodes_at_most / 2;
  return (settings.cells[0] + 1) * (settings.cells[1] + 1) * (settings.cells[2] + 1);
}

/// Roughly proportional to wall time, from measured times of press and drag; only the progress bar depends on it.
double workOf(const ScenePlan& plan, const Settings& settings) {
  const double steps = std::max(plan.duration_s, 0.1) / settings.dt_s;
  double iterations = std::min(settings.solver.iterations, settings.fixedIterations() ? 1000 : 20);
  if (!relaxes(settings.solver.method)) iterations = 100.0;
  if (settings.solver.relaxation == RelaxationKind::kCholesky) iterations = 10.0 + 2.0 * iterations;
  return steps * nodesOf(settings) * (5.0 + iterations);
}

class Grid {
 public:
  Grid(const ScenePlan& plan, bool quick) : shipped_(shippedSettings(plan.scene)), quick_(quick) { add(shipped_); }

  void iterations() {
    for (const RelaxationKind relaxation : {RelaxationKind::kGaussSeidel, RelaxationKind::kCholesky}) {
      const bool swept = relaxation == RelaxationKind::kGaussSeidel;
      // With a factor, what ten iterations leave is not the relaxation's; more of them would take most of a full run.
      const int most = swept ? 100 : 10;
      for (const int count : quick_ ? std::vector{5, 30} : std::vector{1, 2, 5, 10, 20, 50, 100}) {
        if (quick_ || count <= most) addSolver(SolverMethod::kPredictorCorrector, relaxation, count, 0.0);
      }
      for (const double tolerance : quick_ ? std::vector{1e-4} : std::vector{1e-2, 3e-3, 1e-3, 3e-4, 1e-4, 1e-5}) {
        addSolver(SolverMethod::kPredictorCorrector, relaxation, 30, tolerance);
      }
      if (!quick_ && swept) addSolver(SolverMethod::kPredictorCorrector, relaxation, 300, 1e-6);
    }
  }

  void rivals() {
    for (const SolverMethod method : {SolverMethod::kCone4, SolverMethod::kPolyhedral, SolverMethod::kImpulse}) {
      for (const int count : quick_ ? std::vector{10} : std::vector{2, 5, 10}) {
        addSolver(method, RelaxationKind::kGaussSeidel, count, 0.0);
      }
      addSolver(method, shipped_.solver.relaxation, shipped_.solver.iterations, shipped_.solver.tolerance);
    }
  }

  /// Fewer passes over the contacts at a time.
  void passes() {
    for (const int passes : {2, 5}) {
      Settings settings = shipped_;
      settings.solver.contact_passes = passes;
      add(settings);
    }
  }

  void exactRivals() {
    addSolver(SolverMethod::kReference, RelaxationKind::kGaussSeidel, 1000, 1e-10);
    addSolver(SolverMethod::kCondensedLcp, RelaxationKind::kGaussSeidel, 1000, 1e-6);
  }

  void size(const Cells& cells, double dt_s) {
    for (const RelaxationKind relaxation : {RelaxationKind::kGaussSeidel, RelaxationKind::kCholesky}) {
      Settings settings = shipped_;
      settings.cells = cells;
      settings.dt_s = dt_s;
      settings.solver.relaxation = relaxation;
      const bool factor_too_large = relaxation == RelaxationKind::kCholesky && nodesOf(settings) > kLargeMesh;
      if (!factor_too_large && (!quick_ || relaxation == shipped_.solver.relaxation)) add(settings);
    }
  }

  /// A mesh that follows the tool, at tolerances of which one is enough for a haptic device.
  void refined(const RefinementDescription& refinement) {
    for (const double tolerance : {1e-2, 1e-4, shipped_.solver.tolerance}) {
      Settings settings = shipped_;
      settings.refinement = refinement;
      settings.solver.tolerance = tolerance;
      add(settings);
    }
  }

  const std::vector<Settings>& all() const { return all_; }

 private:
  void addSolver(SolverMethod method, RelaxationKind relaxation, int iterations, double tolerance) {
    Settings settings = shipped_;
    settings.solver.method = method;
    settings.solver.relaxation = relaxation;
    settings.solver.iterations = iterations;
    settings.solver.tolerance = tolerance;
    add(settings);
  }

  void add(const Settings& settings) {
    const bool known = std::any_of(all_.begin(), all_.end(), [&](const Settings& other) {
      return sizeOf(other) == sizeOf(settings) && sameSolver(other.solver, settings.solver);
    });
    if (!known) all_.push_back(settings);
  }

  Settings shipped_;
  bool quick_;
  std::vector<Settings> all_;
};

std::string describe(const Settings& settings) {
  const std::string relaxation = relaxes(settings.solver.method) ? relaxationName(settings.solver.relaxation) : "";
  return std::string(solverMethodName(settings.solver.method)) + (relaxation.empty() ? "" : " " + relaxation) + ", " +
         std::to_string(nodesOf(settings)) + " nodes";
}

/// Rows of one scene as they come, with the converged runs they are measured against.
class Sweep {
 public:
  Sweep(const ScenePlan& plan, Progress& progress)
      : plan_(plan), progress_(progress), shipped_(shippedSettings(plan.scene)) {
    result_.scene = plan.scene.name;
    const auto large = [](const Cells& cells) { return (cells[0] + 1) * (cells[1] + 1) * (cells[2] + 1) > kLargeMesh; };
    if (plan.short_motion && std::any_of(plan.meshes.begin(), plan.meshes.end(), large)) {
      result_.notes.push_back("meshes of more than " + std::to_string(kLargeMesh) +
                              " nodes: errors over the beginning of the motion");
    }
    result_.of = plan.has_peer ? "force" : "wrench";
  }

  /// Converged run of a mesh and step, once.
  const Run& converged(const Settings& settings) {
    const auto found = converged_.find(sizeOf(settings));
    if (found != converged_.end()) return found->second;
    Settings shipped_at = shipped_;
    shipped_at.cells = settings.cells;
    shipped_at.dt_s = settings.dt_s;
    shipped_at.refinement = settings.refinement;
    return converged_.emplace(sizeOf(settings), run(convergedSettings(shipped_at), "converged ")).first->second;
  }

  void findTruth() {
    if (!plan_.truth.table.empty()) {
      const TruthTable table = readTruthTable(plan_.truth.table);
      truth_ = truthAt(table, converged(shipped_));
      result_.truth = table.how + " (of the force alone)";
      result_.truth_error = table.uncertainty;
      return;
    }
    result_.truth = "converged run on the finer mesh";
    truth_ = converged(onMesh(plan_.meshes.size()));
    const Run& before = converged(onMesh(plan_.meshes.size() - 1));
    // Linear tetrahedra under a moving contact: between first and second order; the first is the safer guess.
    result_.truth_error = richardsonError(wrenchError(before, truth_).relative, plan_.truth.ratio, 1.0);
  }

  void add(const Settings& settings) {
    const Run& exact = converged(settings);
    const Run run = this->run(settings, "");
    BenchmarkRow row = timed(run.step_s, run.simulated_s);
    row.method = solverMethodName(settings.solver.method);
    if (relaxes(settings.solver.method)) row.relaxation = relaxationName(settings.solver.relaxation);
    row.iterations = settings.solver.iterations;
    row.contact_passes = settings.solver.contact_passes;
    row.tolerance = settings.solver.tolerance;
    row.dt_s = settings.dt_s;
    row.nodes = run.nodes;
    row.refined_cell_m = settings.refinement.cell_m;
    row.solver_error = row.same_mesh_error = wrenchError(run, exact).relative;
    row.total_error = isTruth(settings) ? kNone : wrenchError(run, truth_).relative;
    row.mean_iterations = run.mean_iterations;
    row.met_tolerance = run.met_tolerance;
    row.reference_met = exact.met_tolerance;
    row.discarded = run.discarded;
    row.at_shipped_size = sizeOf(settings) == sizeOf(shipped_);
    row.shipped_solver = sameSolver(settings.solver, shipped_.solver);
    row.shipped = row.at_shipped_size && row.shipped_solver;
    result_.rows.push_back(row);
  }

  void addPeer(const SceneOptions& options, const Settings& settings) {
    for (const bool damped : {true, false}) addPeer(options, settings, damped);
  }

  void addPeer(const SceneOptions& options, const Settings& settings, bool damped) {
    progress_.begin(describe(settings) + ": bullet", 0.5 * workOf(plan_, settings));
    const PressDragMotion motion = pressDragMotion(options, nodesOf(settings) > kLargeMesh);
    const PeerResult peer = runPeer(plan_.scene, settings, motion, damped);
    progress_.end();
    BenchmarkRow row = timed(peer.run.step_s, peer.run.simulated_s);
    row.method = peer.name;
    row.dt_s = settings.dt_s;
    row.nodes = peer.run.nodes;
    row.solver_error = row.mean_iterations = row.met_tolerance = row.reference_met = row.tolerance = kNone;
    row.same_mesh_error = wrenchError(peer.run, sameModel(settings)).relative;
    row.total_error = wrenchError(peer.run, truth_).relative;
    row.at_shipped_size = sizeOf(settings) == sizeOf(shipped_);
    row.peer = true;
    result_.rows.push_back(row);
    char size[64];
    std::snprintf(size, sizeof size, ", %d nodes, %g ms: ", peer.run.nodes, 1e3 * settings.dt_s);
    result_.notes.push_back(peer.name + size + peer.how);
  }

  void note(const std::string& text) { result_.notes.push_back(text); }

  SceneResult finish() {
    Settings half = shipped_;
    half.dt_s *= 0.5;
    const auto halved = converged_.find(sizeOf(half));
    const bool known = halved != converged_.end();
    result_.step_error = known ? wrenchError(converged(shipped_), halved->second).relative : kNone;
    return std::move(result_);
  }

 private:
  /// On the truth's own mesh only the solver differs: no total error.
  bool isTruth(const Settings& settings) const {
    return plan_.truth.table.empty() && settings.cells == plan_.meshes.back();
  }

  /// 0: the shipped mesh, then the others.
  Settings onMesh(std::size_t index) const {
    Settings settings = shipped_;
    if (index > 0) settings.cells = plan_.meshes.at(index - 1);
    return settings;
  }

  Run run(const Settings& settings, const std::string& what) {
    BenchmarkScene scene = plan_.scene;
    if (nodesOf(settings) > kLargeMesh && plan_.short_motion) scene.motion = plan_.short_motion;
    return play(scene, settings, what);
  }

  /// Our converged answer with the peer's elements, each with a change of volume of its own.
  const Run& sameModel(const Settings& settings) {
    const auto found = same_model_.find(sizeOf(settings));
    if (found != same_model_.end()) return found->second;
    BenchmarkScene scene = plan_.scene;
    if (nodesOf(settings) > kLargeMesh && plan_.short_motion) scene.motion = plan_.short_motion;
    for (TissueDescription& tissue : scene.scene.tissues) tissue.material.dilatation = Dilatation::kElement;
    Run run = play(scene, convergedSettings(settings), "converged, elements as the peer's, ");
    return same_model_.emplace(sizeOf(settings), std::move(run)).first->second;
  }

  Run play(const BenchmarkScene& scene, const Settings& settings, const std::string& what) {
    progress_.begin(plan_.scene.name + ": " + what + describe(settings), workOf(plan_, settings));
    const RunProgress progress = [this](double share) { progress_.at(share); };
    Run run = runScene(scene, settings, progress, plan_.duration_s);
    progress_.end();
    if (plan_.has_peer) run.lever_m = 0.0;  // the peer gives no moment: errors are of the force alone
    return run;
  }

  static BenchmarkRow timed(const std::vector<double>& step_s, double simulated_s) {
    BenchmarkRow row;
    row.times = stepTimes(step_s);
    double wall_s = 0.0;
    for (const double s : step_s) wall_s += s;
    row.steps_per_s = static_cast<double>(step_s.size()) / wall_s;
    row.realtime_factor = simulated_s / wall_s;
    return row;
  }

  const ScenePlan& plan_;
  Progress& progress_;
  Settings shipped_;
  std::map<SizeKey, Run> converged_;
  std::map<SizeKey, Run> same_model_;
  Run truth_;
  SceneResult result_;
};

}  // namespace

std::vector<Settings> settingsGrid(const ScenePlan& plan, bool quick) {
  const Settings shipped = shippedSettings(plan.scene);
  Grid grid(plan, quick);
  grid.iterations();
  if (!quick) grid.passes();
  grid.rivals();
  if (plan.exact_rivals) grid.exactRivals();
  for (const double dt : plan.steps_s) grid.size(shipped.cells, dt);
  for (const Cells& cells : plan.meshes) grid.size(cells, shipped.dt_s);
  for (const RefinementDescription& refinement : plan.refinements) grid.refined(refinement);
  return grid.all();
}

SceneResult sweep(const ScenePlan& plan, const SceneOptions& options, Progress& progress) {
  Sweep sweep(plan, progress);
  sweep.findTruth();
  for (const Settings& settings : settingsGrid(plan, options.quick)) sweep.add(settings);
  if (plan.has_peer && hasPeer()) {
    for (const Settings& settings : peerSizes(plan, options)) sweep.addPeer(options, settings);
  }
  if (plan.has_peer && !hasPeer()) sweep.note("built without Bullet (libbullet-dev): no peer in this run");
  return sweep.finish();
}

double sweepWork(const ScenePlan& plan, const SceneOptions& options) {
  std::map<SizeKey, Settings> converged;
  double work = 0.0;
  for (const Settings& settings : settingsGrid(plan, options.quick)) {
    work += workOf(plan, settings);
    converged.emplace(sizeOf(settings), settings);
  }
  for (const auto& [size, settings] : converged) work += workOf(plan, convergedSettings(settings));
  if (plan.has_peer && hasPeer()) {
    for (const Settings& settings : peerSizes(plan, options)) {
      work += workOf(plan, settings) + workOf(plan, convergedSettings(settings));
    }
  }
  return work;
}

}  // namespace tissue_contact
