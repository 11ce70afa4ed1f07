/// Time per implicit step of press-and-drag: sphere of 5 mm radius, 4 mm deep at 20 mm/s, dragged 20 mm at 20 mm/s over
/// a 0.10 x 0.10 x 0.04 m corotational block, dt 1 ms, one core. Reports median, p99 and maximum over the steps of the
/// run, so a machine's noise shows in p99 and not in the median. The argument is the number of cells across: 10 is the
/// 11x11x5-node block of the README.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <sstream>
#include <string>
#include <vector>

#include "tissue_contact/simulation/simulator.h"

namespace tissue_contact {
namespace {

Simulator makeScene(int cells, const std::string& solver) {
  std::ostringstream yaml;
  yaml
      << "tissues:\n  - name: block\n    block: {size_m: [0.10, 0.10, 0.04], cells: [" << cells << ", " << cells << ", "
      << 2 * cells / 5 << "]}\n"
      << "    material: {model: corotational, youngs_modulus_pa: 5000, poissons_ratio: 0.45, density_kg_per_m3: 1000}\n"
      << "    damping: {stiffness_s: 0.003}\n"
      << "    fixed: [{plane: {point_m: [0, 0, 0], normal: [0, 0, 1]}}]\n"
      << "instruments:\n  - name: probe\n    urdf: package://tissue_contact/urdf/probe.urdf\n    tip_link: tip\n"
      << "    joint_state_topics: [/probe/joint_states]\n    base_pose: {position_m: [-0.01, 0, 0.0451]}\n"
      << "    contact_links: [tip]\n"
      << "friction:\n  - {instrument: probe, tissue: block, static: 0.6, kinetic: 0.4}\n"
      << "step: {max_step_s: 0.001}\n"
      << solver;
  SceneEnvironment environment;
  environment.package_path = [](const std::string&) { return std::string(TISSUE_CONTACT_SOURCE_DIR); };
  return Simulator(parseScene(yaml.str(), "benchmark scene", environment.package_path), environment);
}

/// Joint positions at a time of the run: down, then along x.
Vector3 probePosition(double t) {
  constexpr double kSpeed = 0.02;
  constexpr double kDepth = 0.0041;
  const double down = std::min(kSpeed * t, kDepth);
  return {std::min(std::max(kSpeed * t - kDepth, 0.0), 0.02), 0.0, -down};
}

constexpr int kSteps = 1205;

double relativeDifference(const std::vector<Vector3>& forces, const std::vector<Vector3>& reference) {
  double difference = 0.0;
  double size = 0.0;
  for (std::size_t k = 0; k < forces.size(); ++k) {
    difference += (forces[k] - reference[k]).squaredNorm();
    size += reference[k].squaredNorm();
  }
  return std::sqrt(difference / size);
}

std::vector<Vector3> forcesOf(Simulator& simulator) {
  std::vector<Vector3> forces;
  simulator.reset();
  for (int k = 1; k <= kSteps; ++k) {
    simulator.advance(0.001, {probePosition(0.001 * k)});
    forces.push_back(simulator.wrench(0).force);
  }
  return forces;
}

void pressAndDrag(benchmark::State& state) {
  const int cells = static_cast<int>(state.range(0));
  Simulator simulator = makeScene(cells, "");
  std::vector<double> times_ms;
  double iterations = 0.0;
  double contacts = 0.0;
  for (auto _ : state) {
    simulator.reset();
    for (int k = 1; k <= kSteps; ++k) {
      const auto start = std::chrono::steady_clock::now();
      simulator.advance(0.001, {probePosition(0.001 * k)});
      const auto end = std::chrono::steady_clock::now();
      times_ms.push_back(1e3 * std::chrono::duration<double>(end - start).count());
      iterations += simulator.report().iterations;
      contacts += simulator.report().static_contacts + simulator.report().kinetic_contacts;
    }
  }
  std::sort(times_ms.begin(), times_ms.end());
  const auto count = static_cast<double>(times_ms.size());
  state.counters["nodes"] = simulator.tissues()[0].nodeCount();
  state.counters["median_ms"] = times_ms[times_ms.size() / 2];
  state.counters["p99_ms"] = times_ms[times_ms.size() * 99 / 100];
  state.counters["max_ms"] = times_ms.back();
  state.counters["iterations_per_step"] = iterations / count;
  state.counters["touching"] = contacts / count;
  state.counters["final_force_n"] = simulator.wrench(0).force.norm();
  if (state.range(1) == 0) return;
  Simulator converged = makeScene(cells, "solver: {iterations: 5000, tolerance: 1.0e-10}\n");
  state.counters["solver_error_percent"] = 100.0 * relativeDifference(forcesOf(simulator), forcesOf(converged));
}

BENCHMARK(pressAndDrag)->Args({10, 1})->Args({20, 0})->Unit(benchmark::kMillisecond)->MinTime(2.0);

}  // namespace
}  // namespace tissue_contact
