/// @file
/// Room `benchmark`: one run of a scene. A scene, settings and a motion in; wrenches at fixed times and the wall time of
/// every step out.
#pragma once

#include <array>
#include <functional>
#include <string>
#include <vector>

#include "tissue_contact/baselines/solver_description.h"
#include "tissue_contact/core/types.h"
#include "tissue_contact/simulation/scene.h"
#include "tissue_contact/simulation/simulator.h"

namespace tissue_contact {

/// What a motion calls at every time at which runs are compared.
using Sampled = std::function<void(double time_s)>;

/// Moves the instruments from start to end, the same way whatever the step.
using Motion = std::function<void(Simulator& simulator, const Sampled& sampled)>;

/// A scene with the settings it ships with, and what happens in it.
struct BenchmarkScene {
  std::string name;
  Scene scene;
  SceneEnvironment environment;
  Motion motion;
};

/// What a benchmark varies. The tolerance may be 0 here (never met): the number of iterations is then fixed.
struct Settings {
  SolverDescription solver;
  double dt_s = 0.001;
  std::array<int, 3> cells = {0, 0, 0};  ///< of the first tissue's block; 0: as the scene has them
  RefinementDescription refinement;      ///< of the first tissue, a volume; never: as the scene has it
  bool simplified = true;                ///< the scene's advisor may leave out what it bounds the error of

  bool fixedIterations() const { return solver.tolerance == 0.0; }
};

Settings shippedSettings(const BenchmarkScene& scene);

/// The scene with other settings. @throws std::invalid_argument when cells are given and the first tissue is no block.
Scene withSettings(const Scene& scene, const Settings& settings);

struct Run {
  std::vector<double> times_s;                ///< of the samples
  std::vector<std::vector<Wrench>> wrenches;  ///< [sample][instrument], in tip axes, N and N m
  double lever_m = 0.0;                       ///< RMS distance of the contact forces from the tip; 0: no contact
  std::vector<double> step_s;                 ///< wall time of each implicit step
  double simulated_s = 0.0;
  double mean_iterations = 0.0;
  double met_tolerance = 0.0;       ///< share of the steps
  long discarded = 0;               ///< steps without a finite answer
  int nodes = 0;                    ///< of all tissues, at the end
  std::vector<std::string> advice;  ///< what the advisor chose

  double wall_s() const;
};

/// Called with the done share of a run, 0 to 1; may be empty.
using RunProgress = std::function<void(double share)>;

/// @param duration_s of the motion, for progress alone.
Run runScene(const BenchmarkScene& scene, const Settings& settings, const RunProgress& progress = {},
             double duration_s = 0.0);

/// Settings of the answer that solver errors are measured against: the predictor-corrector's fixed point to 1e-10 (1e-8
/// on more than 2000 nodes), or what 500 iterations reach of it (200 there and with a Cholesky factor);
/// Run::met_tolerance tells how often.
Settings convergedSettings(Settings settings);

}  // namespace tissue_contact
