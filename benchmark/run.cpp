#include "benchmark/run.h"

#include <chrono>
#include <cmath>
#include <numeric>
#include <stdexcept>
#include <utility>

namespace tissue_contact {
namespace {

using Clock = std::chrono::steady_clock;

/// Watches a run step by step and sample by sample.
class Recorder {
 public:
  explicit Recorder(Simulator& simulator) : simulator_(simulator) {
    for (Advice& advice : simulator.advice()) run_.advice.push_back(std::move(advice.text));
    simulator_.setStepObserver([this] { step(); });
    last_ = Clock::now();
  }
  Recorder(const Recorder&) = delete;
  Recorder& operator=(const Recorder&) = delete;

  void sample(double time_s) {
    std::vector<Wrench> wrenches;
    for (std::size_t i = 0; i < simulator_.instruments().size(); ++i) {
      wrenches.push_back(simulator_.wrench(static_cast<int>(i)));
    }
    run_.times_s.push_back(time_s);
    run_.wrenches.push_back(std::move(wrenches));
    addLevers();
    last_ = Clock::now();  // looking does not count
  }

  Run finish() {
    simulator_.setStepObserver(nullptr);
    for (const Tissue& tissue : simulator_.tissues()) run_.nodes += tissue.nodeCount();
    const auto steps = static_cast<double>(run_.step_s.size());
    if (steps > 0.0) {
      run_.mean_iterations = iterations_ / steps;
      run_.met_tolerance = met_ / steps;
    }
    if (force2_ > 0.0) run_.lever_m = std::sqrt(moment2_ / force2_);
    return run_;
  }

 private:
  void step() {
    const Clock::time_point now = Clock::now();
    run_.step_s.push_back(std::chrono::duration<double>(now - last_).count());
    const StepReport& report = simulator_.report();
    iterations_ += report.iterations;
    met_ += report.stop == StopReason::kTolerance ? 1.0 : 0.0;
    run_.discarded += report.discarded ? 1 : 0;
    run_.simulated_s += simulator_.lastProblem().dt_s;
    last_ = Clock::now();
  }

  void addLevers() {
    for (const SolvedContact& one : simulator_.contacts()) {
      const int instrument = one.contact.key.instrument;
      if (instrument < 0) continue;
      const int tip = simulator_.instruments()[static_cast<std::size_t>(instrument)].tipLink();
      const Vector3 p_WTip = simulator_.linkPoses(instrument)[static_cast<std::size_t>(tip)].translation();
      const double force2 = one.force_on_tissue_n.squaredNorm();
      force2_ += force2;
      moment2_ += force2 * (one.contact.p_WC - p_WTip).squaredNorm();
    }
  }

  Simulator& simulator_;
  Run run_;
  Clock::time_point last_;
  double iterations_ = 0.0;
  double met_ = 0.0;
  double force2_ = 0.0;
  double moment2_ = 0.0;
};

}  // namespace

Settings shippedSettings(const BenchmarkScene& scene) {
  Settings settings;
  settings.solver = scene.scene.solver;
  settings.dt_s = scene.scene.step.max_step_s;
  if (const auto* block = std::get_if<BlockDescription>(&scene.scene.tissues.at(0).geometry)) {
    settings.cells = block->cells;
  }
  return settings;
}

Scene withSettings(const Scene& scene, const Settings& settings) {
  Scene changed = scene;
  changed.solver = settings.solver;
  if (settings.fixedIterations()) changed.solver.tolerance = 1e-300;
  changed.step.max_step_s = settings.dt_s;
  if (!settings.simplified) changed.advisor.sleep = changed.advisor.adapt_rotations = false;
  if (settings.refinement.mode != RefinementDescription::Mode::kNever) {
    changed.tissues.at(0).refinement = settings.refinement;
  }
  if (settings.cells == std::array<int, 3>{0, 0, 0}) return changed;
  auto* const block = std::get_if<BlockDescription>(&changed.tissues.at(0).geometry);
  if (block == nullptr) throw std::invalid_argument("tissue '" + changed.tissues[0].name + "' is no generated block");
  for (std::size_t axis = 0; axis < 3; ++axis) {
    // As many times the cells, each so much shorter: the growth from cell to cell goes with it.
    block->grading[axis].growth =
        std::pow(block->grading[axis].growth, static_cast<double>(block->cells[axis]) / settings.cells[axis]);
  }
  block->cells = settings.cells;
  return changed;
}

double Run::wall_s() const { return std::accumulate(step_s.begin(), step_s.end(), 0.0); }

Run runScene(const BenchmarkScene& scene, const Settings& settings, const RunProgress& progress, double duration_s) {
  Simulator simulator(withSettings(scene.scene, settings), scene.environment);
  Recorder recorder(simulator);
  scene.motion(simulator, [&](double time_s) {
    if (progress && duration_s > 0.0) progress(time_s / duration_s);
    recorder.sample(time_s);
  });
  return recorder.finish();
}

Settings convergedSettings(Settings settings) {
  // As good as the exact method (their answers over press and drag differ by 0.001 %) in a third of its time. Beyond some
  // thousand nodes fewer iterations and a looser tolerance must do, or the reference would take longer than all it judges.
  constexpr double kManyNodes = 2000.0;
  const double nodes = (settings.cells[0] + 1.0) * (settings.cells[1] + 1.0) * (settings.cells[2] + 1.0);
  constexpr double kLongStep = 0.004;  // s; from here on sweeps do not get there
  const RelaxationKind relaxation = settings.dt_s > kLongStep ? RelaxationKind::kCholesky : settings.solver.relaxation;
  settings.solver = SolverDescription();
  settings.solver.relaxation = relaxation;
  settings.solver.iterations = relaxation == RelaxationKind::kCholesky || nodes > kManyNodes ? 200 : 500;
  settings.solver.tolerance = nodes > kManyNodes ? 1e-8 : 1e-10;
  settings.simplified = false;
  return settings;
}

}  // namespace tissue_contact
