/// What the model advisor saves and what it costs in accuracy: each scene with each of its choices off and on. Prints
/// CSV: scene, feature, ms per step off, on (processor time, least of the repeats), their ratio, error the feature adds to
/// the wrench (RMS over the run, relative to its RMS; 0 where nothing is touched), and the bound stated for it. Where runs
/// differ at all, the error is that of runs with a tighter solver: the default solver's own error would hide
/// it.
/// usage: advisor [SCENE ...] [--repeats N] [--psm FILE.csv]     N 1 by default; no SCENE: all of them. FILE.csv: for the
///   arm of config/psm_dvrk.yaml, times (s, from 0) and positions of the joints that its first line names, as grasp_path.csv
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <ctime>
#include <functional>
#include <map>
#include <sstream>
#include <string>
#include <vector>

#include "simulation/build_scene.h"
#include "support/text_scene.h"
#include "tissue_contact/core/command_line.h"
#include "tissue_contact/tissue/tet_elasticity.h"
#include "validation/joint_path.h"

namespace {

using namespace tissue_contact;

/// A run: the scene, and where the joints are after each step.
struct Run {
  Scene scene;
  int steps = 0;
  double dt_s = 0.001;
  std::function<VectorX(int step)> joints;
};

/// A ball over a corotational block of 0.1 x 0.1 x 0.04 m.
Scene ballOnBlock(int across, int high, const std::string& extra) {
  const std::string cells = std::to_string(across);
  const std::string size = "[" + cells + ", " + cells + ", " + std::to_string(high) + "]";
  return parseScene(blockScene("[0.10, 0.10, 0.04]", size, "model: corotational, poissons_ratio: 0.45") +
                        "instruments:\n" + probeEntry("probe", "/probe/joint_states", "[-0.01, 0, 0.0451]") +
                        "step: {max_step_s: 0.001}\n" + extra,
                    "benchmark scene", ownEnvironment().package_path);
}

const std::string kFriction = "friction:\n  - {instrument: probe, tissue: block, static: 0.6, kinetic: 0.4}\n";

/// 20 mm/s: 4.1 mm down, then along x.
VectorX pressDrag(int step) {
  const double path = 2e-5 * step;
  return Vector3(std::min(std::max(path - 0.0041, 0.0), 0.02), 0.0, -std::min(path, 0.0041));
}

/// Down, held to the end.
VectorX pressHold(int step) { return Vector3(0.0, 0.0, -std::min(2e-5 * step, 0.0041)); }

/// Down, held for 0.1 s, lifted, away to the end.
VectorX pressLift(int step) {
  return step < 300 ? pressHold(step) : VectorX(Vector3(0.0, 0.0, std::min(0.01, -0.0041 + 2e-5 * (step - 300))));
}

VectorX away(int) { return Vector3(0.0, 0.0, 0.01); }

/// The recorded or planned path of an instrument with many joints, linear in between.
Run alongPath(Scene scene, const std::string& file, double dt_s, double end_s) {
  const JointPath path = loadJointPath(file);
  const Instrument instrument = buildInstruments(scene, ownEnvironment()).at(0);
  std::vector<int> column;
  for (const IndependentJoint& joint : instrument.model().joints()) {
    const auto at = std::find(path.joints.begin(), path.joints.end(), joint.name);
    column.push_back(at == path.joints.end() ? -1 : static_cast<int>(at - path.joints.begin()) + 1);
  }
  const Simulator start(scene, ownEnvironment());
  const VectorX& initial = start.jointPositions(0);
  Run run{std::move(scene), static_cast<int>(std::lround(end_s / dt_s)), dt_s, {}};
  run.joints = [path, column, initial, dt_s](int step) {
    const double time = std::min(dt_s * step, path.rows.back()[0]);
    std::size_t next = 1;
    while (next + 1 < path.rows.size() && path.rows[next][0] < time) ++next;
    const std::vector<double>& a = path.rows[next - 1];
    const std::vector<double>& b = path.rows[next];
    VectorX positions = initial;
    for (std::size_t j = 0; j < column.size(); ++j) {
      if (column[j] < 0) continue;
      const double share = (time - a[0]) / (b[0] - a[0]);
      positions[static_cast<Eigen::Index>(j)] = a[column[j]] + share * (b[column[j]] - a[column[j]]);
    }
    return positions;
  };
  return run;
}

struct Outcome {
  double ms_per_step = 0.0;
  std::vector<Vector3> forces;
  double most_held = 0.0;  ///< largest share of the contact force that sleepers were held by
};

Outcome simulate(const Run& run, const AdvisorDescription& advisor) {
  Scene scene = run.scene;
  scene.advisor = advisor;
  Simulator simulator(scene, ownEnvironment());
  simulator.placeInstrument(0, run.joints(0));
  Outcome outcome;
  const std::clock_t start = std::clock();
  for (int k = 1; k <= run.steps; ++k) {
    simulator.advance(run.dt_s, {run.joints(k)});
    outcome.forces.push_back(simulator.wrench(0).force);
    double pressing = 0.0;
    for (const SolvedContact& contact : simulator.contacts()) pressing += contact.force_on_tissue_n.norm();
    if (pressing > 0.0) outcome.most_held = std::max(outcome.most_held, simulator.report().held_force_n / pressing);
  }
  const double elapsed_s = static_cast<double>(std::clock() - start) / CLOCKS_PER_SEC;
  outcome.ms_per_step = 1e3 * elapsed_s / run.steps;
  return outcome;
}

double relativeDifference(const std::vector<Vector3>& forces, const std::vector<Vector3>& reference) {
  double difference = 0.0;
  double size = 0.0;
  for (std::size_t k = 0; k < forces.size(); ++k) {
    difference += (forces[k] - reference[k]).squaredNorm();
    size += reference[k].squaredNorm();
  }
  return size > 0.0 ? std::sqrt(difference / size) : std::sqrt(difference);
}

/// Above this, two runs differ by what the solver leaves undone as much as by anything else.
constexpr double kSolverNoise = 1e-6;

/// The same with a solver that goes on to the end. Takes long.
double convergedError(Run run, const AdvisorDescription& without, const AdvisorDescription& with) {
  run.scene.solver.iterations = 300;
  run.scene.solver.tolerance = 1e-7;
  const Outcome off = simulate(run, without);
  return relativeDifference(simulate(run, with).forces, off.forces);
}

struct Feature {
  const char* name;
  std::function<void(AdvisorDescription&, bool on)> set;
};

const std::vector<Feature>& features() {
  static const std::vector<Feature> all = {
      {"sleep", [](AdvisorDescription& advisor, bool on) { advisor.sleep = on; }},
      {"rotations", [](AdvisorDescription& advisor, bool on) { advisor.adapt_rotations = on; }},
      {"self_contact", [](AdvisorDescription& advisor, bool on) { advisor.skip_folds = on; }},
      {"friction_path", [](AdvisorDescription& advisor, bool on) { advisor.general_friction = !on; }}};
  return all;
}

/// What the documentation promises of the feature, given what the run has shown.
std::string boundOf(const std::string& feature, const Outcome& on) {
  if (feature == "self_contact") return "0";
  if (feature == "friction_path") return "round-off";
  char text[64];
  if (feature == "sleep") {
    std::snprintf(text, sizeof text, "%.2e", on.most_held);
  } else {
    std::snprintf(text, sizeof text, "strain %.1e", 0.5 * TetElasticity::kTurnOn * TetElasticity::kTurnOn);
  }
  return text;
}

void compare(const std::string& name, const Run& run, int repeats) {
  for (const Feature& feature : features()) {
    if (feature.name == std::string("self_contact") && run.scene.tissue_pairs.empty()) continue;
    if (feature.name == std::string("friction_path") && run.scene.friction.empty()) continue;
    AdvisorDescription without;
    // Each feature alone, but that sleep, which hides all others where it works, is on only while it is measured.
    without.sleep = false;
    without.adapt_rotations = false;
    AdvisorDescription with = without;
    feature.set(without, false);
    feature.set(with, true);
    Outcome off, on;
    double off_ms = 1e300, on_ms = 1e300;
    for (int r = 0; r < repeats; ++r) {
      off = simulate(run, without);
      on = simulate(run, with);
      off_ms = std::min(off_ms, off.ms_per_step);
      on_ms = std::min(on_ms, on.ms_per_step);
    }
    double error = relativeDifference(on.forces, off.forces);
    if (error > kSolverNoise) error = convergedError(run, without, with);
    std::printf("%s,%s,%.4f,%.4f,%.3f,%.2e,%s\n", name.c_str(), feature.name, off_ms, on_ms, on_ms / off_ms, error,
                boundOf(feature.name, on).c_str());
    std::fflush(stdout);
  }
}

/// The arm of config/psm_dvrk.yaml along a recording.
Run recordedArm(const std::string& file) {
  const std::string source = TISSUE_CONTACT_SOURCE_DIR;
  return alongPath(loadScene(source + "/config/psm_dvrk.yaml", ownEnvironment().package_path), file, 0.002,
                   loadJointPath(file).rows.back()[0]);
}

std::map<std::string, std::function<Run()>> scenes() {
  const std::string source = TISSUE_CONTACT_SOURCE_DIR;
  const std::string no_friction = "friction:\n  - {instrument: probe, tissue: block, static: 0}\n";
  const std::string folds = "tissue_pairs: [{tissue: block, other: block}]\n";
  const auto ball = [](int across, int high, const std::string& extra, int steps, VectorX (*joints)(int)) {
    return [=] { return Run{ballOnBlock(across, high, extra), steps, 0.001, joints}; };
  };
  return {
      {"drag_605", ball(10, 4, kFriction, 1200, pressDrag)},
      {"drag_3087", ball(20, 6, kFriction, 600, pressDrag)},
      {"drag_605_frictionless", ball(10, 4, no_friction, 1200, pressDrag)},
      {"drag_605_folds", ball(10, 4, kFriction + folds, 600, pressDrag)},
      {"hold_605", ball(10, 4, kFriction, 2000, pressHold)},
      {"hold_3087", ball(20, 6, kFriction, 1500, pressHold)},
      {"lift_605", ball(10, 4, kFriction, 2500, pressLift)},
      {"rest_605", ball(10, 4, kFriction, 1000, away)},
      {"rest_14256", ball(35, 10, kFriction, 1000, away)},
      {"grasp",
       [=] {
         return alongPath(loadScene(source + "/config/grasp.yaml", ownEnvironment().package_path),
                          source + "/config/grasp_path.csv", 0.002, 8.0);
       }},
  };
}

}  // namespace

int main(int argc, char** argv) {
  const CommandLine line({argv + 1, argv + argc}, {{"--repeats", "--psm"}, {}, {}, true});
  const int repeats = static_cast<int>(line.integer("--repeats", 1, 1, 1000));
  const std::vector<std::string>& names = line.words();
  std::printf("scene,feature,ms_per_step_off,ms_per_step_on,ratio,wrench_error_added,bound\n");
  for (const auto& [name, make] : scenes()) {
    if (names.empty() || std::find(names.begin(), names.end(), name) != names.end()) compare(name, make(), repeats);
  }
  if (line.has("--psm")) compare("psm_dvrk", recordedArm(line.value("--psm")), repeats);
  return 0;
}
