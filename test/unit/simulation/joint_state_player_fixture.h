/// @file
/// Small scenes and joint-state samples for the tests of JointStatePlayer: a block touched by probes.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "tissue_contact/scene/load_scene.h"
#include "tissue_contact/simulation/joint_state_player.h"

namespace tissue_contact {

constexpr std::int64_t kSecond = 1000000000;
constexpr std::int64_t kMillisecond = 1000000;

/// Top face of the block at z = 0.02; with joints at 0 a probe's ball (radius 5 mm) just does not touch it.
inline const char* const kTissue = R"(
tissues:
  - name: block
    block: {size_m: [0.06, 0.06, 0.02], cells: [4, 4, 2]}
    material: {youngs_modulus_pa: 5000, poissons_ratio: 0.4, density_kg_per_m3: 1000}
    damping: {stiffness_s: 0.003}
    fixed: [{plane: {point_m: [0, 0, 0], normal: [0, 0, 1]}}]
step: {max_step_s: 0.001, max_gap_s: 0.05}
)";

inline std::string probe(const std::string& name, const std::string& topics, double x) {
  return "  - name: " + name + "\n    urdf: package://tissue_contact/urdf/probe.urdf\n    base_pose: {position_m: [" +
         std::to_string(x) + ", 0, 0.026]}\n    joint_state_topics: [" + topics +
         "]\n    joint_names: {recorded_z: z}\n    tip_link: tip\n    contact_links: [tip]\n";
}

inline std::unique_ptr<Simulator> makeSimulator(const std::string& instruments) {
  const PackagePath package_path = [](const std::string&) { return std::string(TISSUE_CONTACT_SOURCE_DIR); };
  SceneEnvironment environment;
  environment.package_path = package_path;
  const std::string yaml = std::string(kTissue) + "instruments:\n" + instruments;
  return std::make_unique<Simulator>(parseScene(yaml, "test.yaml", package_path), environment);
}

inline JointStateSample sample(std::int64_t stamp_ns, double z) { return {stamp_ns, {"x", "y", "z"}, {0.0, 0.0, z}}; }

/// Everything that is ready, in the order it is played.
inline std::vector<PlayedSample> drain(JointStatePlayer& player) {
  std::vector<PlayedSample> all;
  while (auto played = player.playNext()) all.push_back(*played);
  return all;
}

/// A press that moves a little sideways: 30 samples at 10 ms, from `start_ns`.
inline std::vector<JointStateSample> press(std::int64_t start_ns, double depth) {
  std::vector<JointStateSample> samples;
  samples.reserve(30);
  for (int i = 0; i < 30; ++i) {
    samples.push_back({start_ns + i * 10 * kMillisecond, {"x", "y", "z"}, {1e-4 * i, 0.0, -depth * i / 29.0}});
  }
  return samples;
}

/// What a run leaves behind after each accepted sample, for comparison bit by bit.
struct Trace {
  std::vector<std::int64_t> stamps;
  std::vector<double> forces;

  void add(const PlayedSample& played, const Simulator& simulator) {
    stamps.push_back(played.stamp_ns);
    for (const int i : played.instruments) {
      const Wrench wrench = simulator.wrench(i);
      forces.insert(forces.end(), wrench.force.data(), wrench.force.data() + 3);
      forces.insert(forces.end(), wrench.torque.data(), wrench.torque.data() + 3);
    }
  }
  bool pressed() const {
    return std::any_of(forces.begin(), forces.end(), [](double f) { return std::abs(f) > 1e-3; });
  }
  friend bool operator==(const Trace& a, const Trace& b) { return a.stamps == b.stamps && a.forces == b.forces; }
};

}  // namespace tissue_contact
