/// @file
/// Room `validation`: the scene most hard cases vary: a pad with its base fixed and a probe that presses, drags and
/// lifts.
#pragma once

#include <cmath>
#include <sstream>

#include "support/replaced.h"
#include "support/text_scene.h"
#include "validation/hard/hard_run.h"

namespace tissue_contact {

/// Pad of 60 x 60 x 30 mm whose upper face is at z = 30 mm, 405 nodes; a sphere of 10 mm that touches it at joints 0.
struct PadScene {
  std::string block = "{size_m: [0.06, 0.06, 0.03], cells: [8, 8, 4]}";
  std::string tissue;  ///< instead of a block: `mesh: {...}` or `sheet: {...}`
  std::string model = "corotational";
  double youngs_modulus_pa = 5000.0;
  double poissons_ratio = 0.45;
  double damping_s = 0.003;
  std::string regions;  ///< list in flow style
  double mu_static = 0.4;
  double mu_kinetic = 0.3;
  double step_s = 0.001;
  std::string solver = "{}";  ///< the defaults
  double radius_m = 0.01;
  std::string more;      ///< further lines of the scene
  std::string urdf;      ///< instead of a sphere's
  double start_m = 0.0;  ///< of joint z: where the probe is before the first step
};

/// The probe with another shape in place of its ball.
inline std::string tipUrdf(const std::string& geometry) {
  return replaced(probeUrdf(1.0), "<sphere radius='" + std::to_string(1.0) + "'/>", geometry);
}

inline Simulator makePad(const PadScene& scene) {
  std::ostringstream yaml;
  yaml.precision(17);
  yaml << "tissues:\n  - name: pad\n    " << (scene.tissue.empty() ? "block: " + scene.block : scene.tissue)
       << "\n    material: {model: " << scene.model << ", youngs_modulus_pa: " << scene.youngs_modulus_pa
       << ", poissons_ratio: " << scene.poissons_ratio << ", density_kg_per_m3: 1000}\n"
       << "    damping: {stiffness_s: " << scene.damping_s << "}\n"
       << (scene.regions.empty() ? "" : "    regions: " + scene.regions + "\n")
       << "    fixed: [{plane: {point_m: [0, 0, 0], normal: [0, 0, 1]}}]\n"
       << "instruments:\n  - {name: probe, robot_description: probe, tip_link: tip, contact_links: [tip],"
       << " joint_state_topics: [/joint_states], initial_joint_positions: {z: " << scene.start_m
       << "}, base_pose: {position_m: [0, 0, " << 0.03 + scene.radius_m << "]}}\n"
       << "friction:\n  - {instrument: probe, tissue: pad, static: " << scene.mu_static
       << ", kinetic: " << scene.mu_kinetic << "}\n"
       << "step: {max_step_s: " << scene.step_s << "}\nsolver: " << scene.solver << "\n"
       << scene.more;
  return makeSimulator(yaml.str(), {{"probe", scene.urdf.empty() ? probeUrdf(scene.radius_m) : scene.urdf}});
}

/// A cycle: press, drag there and back, lift; each a share of the period.
struct PressDrag {
  double depth_m = 0.004;
  double way_m = 0.008;    ///< along x
  double clear_m = 0.001;  ///< above the face between two cycles
  double period_s = 0.4;
  Vector3 at_m = Vector3::Zero();  ///< where it presses

  Vector3 at(double t) const {
    const double s = t / period_s - std::floor(t / period_s);
    const auto part = [&](double from, double to) { return std::min(1.0, std::max(0.0, (s - from) / (to - from))); };
    const double down = part(0.0, 0.2) - part(0.8, 1.0);
    return at_m + Vector3(way_m * (part(0.25, 0.5) - 2.0 * part(0.5, 0.75) + part(0.8, 1.0)), 0.0,
                          clear_m - (clear_m + depth_m) * down);
  }
};

inline void runCycles(Simulator& simulator, const PressDrag& path, double step_s, int steps, const Report& report,
                      double from = 0.0, double to = 1.0) {
  for (int k = 1; k <= steps; ++k) {
    simulator.advance(step_s, {path.at(k * step_s)});
    if (k % 100 == 0) report.progress(from + (to - from) * k / steps);
  }
}

/// 2000 steps of a pad under such cycles, reported under `name`; `from` to `to` is its share of the case.
inline void runPad(const std::string& name, const PadScene& scene, const PressDrag& path, const HardBands& bands,
                   Report& report, double from = 0.0, double to = 1.0, int reference_every = 41) {
  Simulator simulator = makePad(scene);
  simulator.placeInstrument(0, path.at(0.0));
  HardRun run(simulator, reference_every);
  runCycles(simulator, path, scene.step_s, 2000, report, from, to);
  run.report(name, bands, report);
}

}  // namespace tissue_contact
