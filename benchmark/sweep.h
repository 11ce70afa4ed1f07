/// @file
/// Room `benchmark`: a scene over solvers, relaxations, iterations, steps and meshes. A plan in; a table of times and
/// errors out.
#pragma once

#include <map>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include "benchmark/measures.h"
#include "benchmark/progress.h"
#include "benchmark/scenes.h"

namespace tissue_contact {

/// One line of the table.
struct BenchmarkRow {
  std::string method;
  std::string relaxation;  ///< empty where there is none
  int iterations = 0;
  int contact_passes = 0;
  double tolerance = 0.0;  ///< 0: the number of iterations is fixed
  double dt_s = 0.0;
  int nodes = 0;
  double refined_cell_m = 0.0;  ///< finest cells of a mesh that follows the tool; 0: it does not
  StepTimes times;
  double steps_per_s = 0.0;
  double realtime_factor = 0.0;  ///< simulated over wall time: above 1, the scene keeps up with the robot
  double solver_error = 0.0;     ///< NaN: none (peer)
  double total_error = 0.0;      ///< NaN: on the mesh that is the truth itself
  double same_mesh_error =
      0.0;  ///< against the converged run of the same mesh, step and elements; ours: the solver error
  double mean_iterations = 0.0;
  double met_tolerance = 0.0;    ///< share of the steps
  double reference_met = 0.0;    ///< share of the steps of the converged run that met its tolerance
  long discarded = 0;            ///< steps without a finite answer
  bool shipped = false;          ///< the settings the scene ships with, on the mesh and step it ships with
  bool shipped_solver = false;   ///< the settings it ships with, on any mesh and step
  bool at_shipped_size = false;  ///< mesh and step are those it ships with
  bool peer = false;
};

struct SceneResult {
  std::string scene;
  std::string of;            ///< what the errors are of: "force" or "wrench"
  std::string truth;         ///< what total errors are measured against
  double truth_error = 0.0;  ///< its own, estimated or published, relative
  double step_error = 0.0;   ///< of the shipped step against half of it, both converged, relative; NaN: not measured
  std::vector<BenchmarkRow> rows;
  std::vector<std::string> notes;  ///< e.g. why there is no peer
};

/// The settings to run, the shipped ones first.
std::vector<Settings> settingsGrid(const ScenePlan& plan, bool quick);

/// Runs the whole grid, and the peer where there is one. @throws std::runtime_error when a reference run fails.
SceneResult sweep(const ScenePlan& plan, const SceneOptions& options, Progress& progress);

/// The work of sweep() in the unit of Progress.
double sweepWork(const ScenePlan& plan, const SceneOptions& options);

}  // namespace tissue_contact
