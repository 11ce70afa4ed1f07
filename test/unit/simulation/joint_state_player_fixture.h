/// @file
/// Small scenes and joint-state samples for the tests of JointStatePlayer: a block touched by probes.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "support/text_scene.h"
#include "tissue_contact/simulation/joint_state_player.h"

namespace tissue_contact {

constexpr std::int64_t kSecond = 1000000000;
constexpr std::int64_t kMillisecond = 1000000;

/// With joints at 0 its ball (radius 5 mm) just does not touch the block, whose top face is at z = 0.02.
inline std::string probe(const std::string& name, const std::string& topics, double x) {
  return probeEntry(name, topics, "[" + std::to_string(x) + ", 0, 0.026]");
}

inline std::unique_ptr<Simulator> blockTouchedBy(const std::string& instruments) {
  return std::make_unique<Simulator>(
      makeSimulator(blockScene() + "step: {max_step_s: 0.001, max_gap_s: 0.05}\ninstruments:\n" + instruments));
}

inline std::unique_ptr<Simulator> oneProbe() { return blockTouchedBy(probe("a", "/a", 0.0)); }
inline std::unique_ptr<Simulator> twoProbes() {
  return blockTouchedBy(probe("a", "/a", -0.015) + probe("b", "/b", 0.015));
}

/// A player of joint states for one probe, or for two with a topic each: "/a" and "/b".
class OneProbe : public testing::Test {
 protected:
  const std::unique_ptr<Simulator> simulator = oneProbe();
  JointStatePlayer player{*simulator};
};
class TwoProbes : public testing::Test {
 protected:
  const std::unique_ptr<Simulator> simulator = twoProbes();
  JointStatePlayer player{*simulator};
};

inline JointStateSample sample(std::int64_t stamp_ns, double z) { return {stamp_ns, {"x", "y", "z"}, {0.0, 0.0, z}}; }

/// Of the drivers of an arm and of its jaw.
inline JointStateSample arm(std::int64_t stamp_ns, double x) { return {stamp_ns, {"x", "y"}, {x, 0.0}}; }
inline JointStateSample jaw(std::int64_t stamp_ns, double z) { return {stamp_ns, {"z"}, {z}}; }

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

using Order = std::vector<std::pair<int, JointStateSample>>;

/// Pushes (topic, sample) in the given order, and plays what is ready after each.
inline Trace run(Simulator& simulator, JointStatePlayer& player, const Order& order) {
  Trace trace;
  const auto take = [&] {
    while (const auto played = player.playNext()) {
      if (played->verdict == Verdict::kAccepted) trace.add(*played, simulator);
    }
  };
  for (const auto& [topic, s] : order) {
    player.push(topic, s);
    take();
  }
  player.finish();
  take();
  return trace;
}

/// run(), where nothing is refused.
inline Trace runAll(Simulator& simulator, JointStatePlayer& player, const Order& order) {
  Trace trace = run(simulator, player, order);
  for (int v = 1; v < kVerdictCount; ++v) {
    EXPECT_EQ(player.count(static_cast<Verdict>(v)), 0) << verdictText(static_cast<Verdict>(v));
  }
  return trace;
}

/// All joint states that were pushed, by what became of them.
inline std::int64_t countedBy(const JointStatePlayer& player) {
  std::int64_t sum = player.merged() + player.waiting();
  for (int v = 0; v < kVerdictCount; ++v) sum += player.count(static_cast<Verdict>(v));
  return sum;
}

}  // namespace tissue_contact
