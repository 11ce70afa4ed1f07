/// @file
/// Room `benchmark`: the scenes that are measured, each with its meshes, steps and what the total error is measured
/// against.
#pragma once

#include <string>
#include <vector>

#include "benchmark/run.h"

namespace tissue_contact {

/// The best answer there is, for total errors.
struct TruthPlan {
  /// File of the truth, see truth_table.h. Empty: the converged run of the finest of the scene's meshes, whose error the one
  /// before it tells.
  std::string table;
  double ratio = 0.0;  ///< of those two mesh sizes
};

constexpr int kLargeMesh = 10000;

struct ScenePlan {
  BenchmarkScene scene;
  double duration_s = 0.0;
  Motion short_motion;       ///< the beginning, for meshes of more than kLargeMesh nodes; null: all of it
  bool exact_rivals = true;  ///< run `reference` and `condensed_lcp`, whose time goes with the cube of the contacts
  std::vector<std::array<int, 3>> meshes;  ///< beside the shipped one, coarse to fine
  std::vector<RefinementDescription>
      refinements;              ///< of the shipped one: meshes that follow the tool, with cells and nodes given
  std::vector<double> steps_s;  ///< beside the shipped one
  TruthPlan truth;
  bool has_peer = false;
};

struct SceneOptions {
  bool quick = false;
  std::string robot_bag;  ///< empty: no robot scenes
};

/// Press and drag, for the peer as well: one coefficient of friction, a sphere of 5 mm, 4 mm deep at 20 mm/s, dragged at
/// 20 mm/s.
struct PressDragMotion {
  double speed_m_per_s = 0.02;
  double gap_m = 0.0002;
  double depth_m = 0.004;
  double drag_m = 0.02;
  double sample_s = 0.01;

  double duration_s() const { return (gap_m + depth_m + drag_m) / speed_m_per_s; }
  Motion motion() const;
  Vector3 jointsAt(double time_s) const;  ///< x, y, z of the probe, m; 0 at the start
};
constexpr double kPressDragMu = 0.4;
constexpr double kProbeRadius = 0.005;  ///< m, urdf/probe.urdf
/// @param beginning only its first 4 mm of drag, as short_motion has them
PressDragMotion pressDragMotion(const SceneOptions& options, bool beginning = false);
Vector3 pressDragBase();  ///< of the probe, m

ScenePlan pressDragPlan(const SceneOptions& options);
ScenePlan graspPlan(const SceneOptions& options);
ScenePlan partialSlipPlan(const SceneOptions& options);
/// A recorded arm touches a pad with the end of one jaw. @throws std::runtime_error when the bag cannot be used.
ScenePlan robotPlan(const SceneOptions& options);
/// The same arm sweeps its jaws through a slab. @throws std::runtime_error when the bag cannot be used.
ScenePlan robotSweepPlan(const SceneOptions& options);

}  // namespace tissue_contact
