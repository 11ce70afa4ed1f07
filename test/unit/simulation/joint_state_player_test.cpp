/// @file
/// JointStatePlayer: order, placement, refusals, loops, gaps and waiting, on a small block touched by two probes.
#include "tissue_contact/simulation/joint_state_player.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "tissue_contact/scene/load_scene.h"

namespace tissue_contact {
namespace {

constexpr std::int64_t kSecond = 1000000000;
constexpr std::int64_t kMillisecond = 1000000;
constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// Top face of the block at z = 0.02; with joints at 0 a probe's ball (radius 5 mm) just does not touch it.
const char* const kTissue = R"(
tissues:
  - name: block
    block: {size_m: [0.06, 0.06, 0.02], cells: [4, 4, 2]}
    material: {youngs_modulus_pa: 5000, poissons_ratio: 0.4, density_kg_per_m3: 1000}
    damping: {stiffness_s: 0.003}
    fixed: [{plane: {point_m: [0, 0, 0], normal: [0, 0, 1]}}]
step: {max_step_s: 0.001, max_gap_s: 0.05}
)";

std::string probe(const std::string& name, const std::string& topics, double x) {
  return "  - name: " + name + "\n    urdf: package://tissue_contact/urdf/probe.urdf\n    base_pose: {position_m: [" +
         std::to_string(x) + ", 0, 0.026]}\n    joint_state_topics: [" + topics +
         "]\n    joint_names: {recorded_z: z}\n    tip_link: tip\n    contact_links: [tip]\n";
}

std::unique_ptr<Simulator> makeSimulator(const std::string& instruments) {
  const PackagePath package_path = [](const std::string&) { return std::string(TISSUE_CONTACT_SOURCE_DIR); };
  SceneEnvironment environment;
  environment.package_path = package_path;
  const std::string yaml = std::string(kTissue) + "instruments:\n" + instruments;
  return std::make_unique<Simulator>(parseScene(yaml, "test.yaml", package_path), environment);
}

std::unique_ptr<Simulator> oneProbe() { return makeSimulator(probe("a", "/a", 0.0)); }
std::unique_ptr<Simulator> twoProbes() { return makeSimulator(probe("a", "/a", -0.015) + probe("b", "/b", 0.015)); }

JointStateSample sample(std::int64_t stamp_ns, double z) { return {stamp_ns, {"x", "y", "z"}, {0.0, 0.0, z}}; }

/// Everything that is ready, in the order it is played.
std::vector<PlayedSample> drain(JointStatePlayer& player) {
  std::vector<PlayedSample> all;
  while (auto played = player.playNext()) all.push_back(*played);
  return all;
}

PlayedSample playOne(JointStatePlayer& player, int topic, const JointStateSample& s) {
  player.push(topic, s);
  const std::vector<PlayedSample> all = drain(player);
  EXPECT_EQ(all.size(), 1U);
  return all.empty() ? PlayedSample() : all.front();
}

/// A press that moves a little sideways: 30 samples at 10 ms, from `start_ns`.
std::vector<JointStateSample> press(std::int64_t start_ns, double depth) {
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

/// Pushes (topic, sample) in the given order, draining after each.
Trace run(Simulator& simulator, JointStatePlayer& player, const std::vector<std::pair<int, JointStateSample>>& order) {
  Trace trace;
  const auto drainInto = [&] {
    while (auto played = player.playNext()) {
      if (played->verdict == Verdict::kAccepted) trace.add(*played, simulator);
    }
  };
  for (const auto& [topic, s] : order) {
    player.push(topic, s);
    drainInto();
  }
  player.finish();
  drainInto();
  return trace;
}

TEST(JointStatePlayer, ListsDistinctTopicsInOrderOfFirstMention) {
  const auto simulator = makeSimulator(probe("a", "/second, /first", -0.015) + probe("b", "/first, /third", 0.015));
  const JointStatePlayer player(*simulator);
  EXPECT_EQ(player.topics(), (std::vector<std::string>{"/second", "/first", "/third"}));
}

TEST(JointStatePlayer, RefusesASceneWithoutTopics) {
  const auto simulator = makeSimulator(
      "  - name: plate\n    urdf: package://tissue_contact/urdf/incline.urdf\n    tip_link: plate\n"
      "    base_pose: {position_m: [0, 0, -0.5]}\n    contact_links: [plate]\n");
  EXPECT_THROW(JointStatePlayer{*simulator}, std::invalid_argument);
}

TEST(JointStatePlayer, FirstSamplePlacesWithoutAStep) {
  const auto simulator = oneProbe();
  JointStatePlayer player(*simulator);
  const PlayedSample played = playOne(player, 0, sample(kSecond, -0.004));
  EXPECT_EQ(played.verdict, Verdict::kAccepted);
  EXPECT_EQ(played.stamp_ns, kSecond);
  EXPECT_EQ(played.instruments, std::vector<int>{0});
  EXPECT_EQ(simulator->stepCount(), 0);
  EXPECT_EQ(simulator->jointPositions(0), Vector3(0, 0, -0.004));
  EXPECT_EQ(simulator->wrench(0).force, Vector3::Zero());
}

TEST(JointStatePlayer, AdvancesFromStampToStamp) {
  const auto simulator = oneProbe();
  JointStatePlayer player(*simulator);
  playOne(player, 0, sample(kSecond, 0.0));
  const PlayedSample played = playOne(player, 0, sample(kSecond + 10 * kMillisecond, -0.002));
  EXPECT_FALSE(played.was_gap);
  EXPECT_FALSE(played.was_reset);
  EXPECT_EQ(simulator->stepCount(), 10);
  EXPECT_EQ(simulator->jointPositions(0), Vector3(0, 0, -0.002));
  EXPECT_GT(simulator->wrench(0).force.z(), 0.0);
}

TEST(JointStatePlayer, JointsHeardLaterArePlacedNotMoved) {
  const auto simulator = oneProbe();
  JointStatePlayer player(*simulator);
  playOne(player, 0, {kSecond, {"z"}, {0.01}});
  EXPECT_EQ(simulator->jointPositions(0), Vector3(0, 0, 0.01));
  // Half a metre in 10 ms would need far more steps than 10 if it were a motion.
  playOne(player, 0, {kSecond + 10 * kMillisecond, {"x"}, {0.5}});
  EXPECT_EQ(simulator->jointPositions(0), Vector3(0.5, 0, 0.01));
  EXPECT_EQ(simulator->stepCount(), 10);
  EXPECT_FALSE(simulator->report().jumped);
  playOne(player, 0, {kSecond + 20 * kMillisecond, {"z"}, {0.02}});
  EXPECT_EQ(simulator->jointPositions(0), Vector3(0.5, 0, 0.02));
}

TEST(JointStatePlayer, TakesReorderedAndMappedNamesAndIgnoresUnknownOnes) {
  const auto simulator = oneProbe();
  JointStatePlayer player(*simulator);
  const PlayedSample played =
      playOne(player, 0, {kSecond, {"jaw", "recorded_z", "y", "x"}, {kNaN, 0.003, 0.002, 0.001}});
  EXPECT_EQ(played.verdict, Verdict::kAccepted) << played.detail;
  EXPECT_EQ(simulator->jointPositions(0), Vector3(0.001, 0.002, 0.003));
}

struct BadSample {
  const char* what;
  JointStateSample sample;
  Verdict verdict;
  const char* named;
};

TEST(JointStatePlayer, RefusesBadSamplesAndGoesOnAsIfTheyHadNotCome) {
  const std::int64_t next = kSecond + 10 * kMillisecond;
  const std::vector<BadSample> bad = {
      {"NaN", {next, {"x", "z"}, {0.0, kNaN}}, Verdict::kNotFinite, "'z'"},
      {"infinite", {next, {"x", "z"}, {-kInfinity, 0.0}}, Verdict::kNotFinite, "-inf"},
      {"mapped NaN", {next, {"recorded_z"}, {kNaN}}, Verdict::kNotFinite, "recorded_z"},
      {"NaN far in the future", {100 * kSecond, {"z"}, {kNaN}}, Verdict::kNotFinite, "'z'"},
      {"NaN in the past", {1, {"z"}, {kNaN}}, Verdict::kNotFinite, "'z'"},
      {"too few positions", {next, {"x", "z"}, {0.0}}, Verdict::kBadLength, "2 names but 1"},
      {"too many positions", {next, {"x"}, {0.0, 1.0}}, Verdict::kBadLength, "1 names but 2"},
      {"nothing known", {next, {"jaw", "elbow"}, {0.0, 0.0}}, Verdict::kNoKnownJoint, "elbow"},
      {"empty", {next, {}, {}}, Verdict::kNoKnownJoint, "joint"},
      {"stamp zero", sample(0, 0.0), Verdict::kBadStamp, "stamp"},
      {"negative stamp", sample(-5, 0.0), Verdict::kBadStamp, "stamp"},
      {"duplicate stamp", sample(kSecond, 0.001), Verdict::kDuplicateStamp, "same stamp"},
  };
  for (const BadSample& b : bad) {
    SCOPED_TRACE(b.what);
    const auto simulator = oneProbe();
    JointStatePlayer player(*simulator);
    playOne(player, 0, sample(kSecond, 0.0));
    const PlayedSample refused = playOne(player, 0, b.sample);
    EXPECT_EQ(refused.verdict, b.verdict);
    EXPECT_NE(refused.detail.find(b.named), std::string::npos) << refused.detail;
    EXPECT_NE(refused.detail.find("/a"), std::string::npos) << refused.detail;
    EXPECT_TRUE(refused.instruments.empty());
    EXPECT_EQ(player.count(b.verdict), 1);
    EXPECT_EQ(simulator->stepCount(), 0);
    EXPECT_EQ(simulator->jointPositions(0), Vector3::Zero());

    const PlayedSample good = playOne(player, 0, sample(next, -0.001));
    EXPECT_EQ(good.verdict, Verdict::kAccepted) << good.detail;
    EXPECT_FALSE(good.was_reset);
    EXPECT_EQ(simulator->stepCount(), 10);
    EXPECT_EQ(player.count(Verdict::kAccepted), 2);
    EXPECT_EQ(player.resets(), 0);
  }
}

TEST(JointStatePlayer, RefusesABadFirstSample) {
  const auto simulator = oneProbe();
  JointStatePlayer player(*simulator);
  EXPECT_EQ(playOne(player, 0, sample(kSecond, kNaN)).verdict, Verdict::kNotFinite);
  EXPECT_EQ(playOne(player, 0, sample(kSecond, -0.001)).verdict, Verdict::kAccepted);
  EXPECT_EQ(simulator->jointPositions(0), Vector3(0, 0, -0.001));
}

TEST(JointStatePlayer, LongIntervalIsSimulatedAsMaxGap) {
  const auto simulator = oneProbe();
  JointStatePlayer player(*simulator);
  playOne(player, 0, sample(kSecond, 0.0));
  EXPECT_FALSE(playOne(player, 0, sample(kSecond + 50 * kMillisecond, 0.0)).was_gap);
  EXPECT_EQ(simulator->stepCount(), 50);
  const PlayedSample played = playOne(player, 0, sample(4000000000 * kSecond, 0.001));
  EXPECT_TRUE(played.was_gap);
  EXPECT_EQ(player.gaps(), 1);
  EXPECT_EQ(simulator->stepCount(), 100);
  EXPECT_EQ(simulator->jointPositions(0), Vector3(0, 0, 0.001));
}

TEST(JointStatePlayer, TimeGoingBackResetsOnceAndRepeatsTheSameBits) {
  const auto simulator = oneProbe();
  JointStatePlayer player(*simulator);
  std::vector<Trace> loops;
  for (int loop = 0; loop < 3; ++loop) {
    Trace trace;
    int resets = 0;
    for (const JointStateSample& s : press(kSecond, 0.006)) {
      const PlayedSample played = playOne(player, 0, s);
      resets += static_cast<int>(played.was_reset);
      trace.add(played, *simulator);
    }
    EXPECT_EQ(resets, loop == 0 ? 0 : 1);
    EXPECT_TRUE(trace.pressed());
    loops.push_back(trace);
  }
  EXPECT_EQ(player.resets(), 2);
  EXPECT_TRUE(loops[0] == loops[1]);
  EXPECT_TRUE(loops[0] == loops[2]);
}

TEST(JointStatePlayer, ALoopForgetsWhichJointsWereHeard) {
  const auto simulator = oneProbe();
  JointStatePlayer player(*simulator);
  playOne(player, 0, {2 * kSecond, {"x", "z"}, {0.3, 0.01}});
  EXPECT_TRUE(playOne(player, 0, {kSecond, {"z"}, {0.02}}).was_reset);
  EXPECT_EQ(simulator->jointPositions(0), Vector3(0, 0, 0.02));
}

TEST(JointStatePlayer, WaitsForTheOtherTopic) {
  const auto simulator = twoProbes();
  JointStatePlayer player(*simulator);
  player.push(0, sample(kSecond, 0.0));
  EXPECT_TRUE(drain(player).empty());
  player.push(1, sample(kSecond + kMillisecond, 0.0));
  const std::vector<PlayedSample> first = drain(player);
  ASSERT_EQ(first.size(), 1U);  // the second topic's sample waits for the first's next one
  EXPECT_EQ(first[0].topic, 0);
  EXPECT_EQ(first[0].instruments, std::vector<int>{0});
  player.push(0, sample(kSecond + 10 * kMillisecond, 0.0));
  const std::vector<PlayedSample> second = drain(player);
  ASSERT_EQ(second.size(), 1U);
  EXPECT_EQ(second[0].topic, 1);
  EXPECT_EQ(second[0].instruments, std::vector<int>{1});
}

TEST(JointStatePlayer, SameStampOnTwoTopicsNeedsNoWaitAndNoStep) {
  const auto simulator = twoProbes();
  JointStatePlayer player(*simulator);
  for (int i = 0; i < 3; ++i) {
    const std::int64_t stamp = kSecond + i * 10 * kMillisecond;
    player.push(1, sample(stamp, 0.001 * i));
    EXPECT_TRUE(drain(player).empty());
    player.push(0, sample(stamp, -0.001 * i));
    const std::vector<PlayedSample> played = drain(player);
    ASSERT_EQ(played.size(), 2U);
    EXPECT_EQ(played[0].topic, 0);
    EXPECT_EQ(played[1].topic, 1);
    EXPECT_EQ(played[1].verdict, Verdict::kAccepted);
    EXPECT_EQ(played[1].instruments, std::vector<int>{1});
    EXPECT_EQ(simulator->stepCount(), 10 * i);
  }
  EXPECT_EQ(simulator->jointPositions(0).z(), -0.002);
  EXPECT_EQ(simulator->jointPositions(1).z(), 0.001);  // its newest target takes effect in the next interval
}

TEST(JointStatePlayer, StopsWaitingAfterMaxGapAndRefusesWhatComesLate) {
  const auto simulator = twoProbes();
  JointStatePlayer player(*simulator);
  player.push(0, sample(kSecond, 0.0));
  player.push(0, sample(kSecond + 49 * kMillisecond, 0.0));
  EXPECT_TRUE(drain(player).empty());
  player.push(0, sample(kSecond + 50 * kMillisecond, 0.0));
  EXPECT_EQ(drain(player).size(), 1U);
  player.push(1, sample(kSecond - kMillisecond, -0.001));
  const std::vector<PlayedSample> late = drain(player);
  ASSERT_FALSE(late.empty());
  EXPECT_EQ(late[0].verdict, Verdict::kLate);
  EXPECT_NE(late[0].detail.find("already at 1.000000000 s"), std::string::npos) << late[0].detail;
  EXPECT_EQ(player.count(Verdict::kLate), 1);
  EXPECT_EQ(simulator->jointPositions(1), Vector3::Zero());
}

TEST(JointStatePlayer, FinishReleasesWhatWaits) {
  const auto simulator = twoProbes();
  JointStatePlayer player(*simulator);
  player.push(0, sample(kSecond, 0.0));
  player.push(0, sample(kSecond + kMillisecond, 0.0));
  EXPECT_TRUE(drain(player).empty());
  player.finish();
  EXPECT_EQ(drain(player).size(), 2U);
}

TEST(JointStatePlayer, WaitingSamplesAreBoundedInNumber) {
  const auto simulator = twoProbes();
  JointStatePlayer player(*simulator);
  std::int64_t stamp = kSecond;
  for (std::size_t i = 0; i < JointStatePlayer::kMaxWaiting; ++i) player.push(0, sample(stamp += 1000, 0.0));
  EXPECT_TRUE(drain(player).empty());
  player.push(0, sample(stamp + 1000, 0.0));
  EXPECT_EQ(drain(player).size(), 1U);
}

/// Samples of two topics in the order of their stamps, topic 1 shifted by 3 ms.
std::vector<std::pair<int, JointStateSample>> twoPresses() {
  std::vector<std::pair<int, JointStateSample>> order;
  const std::vector<JointStateSample> a = press(kSecond, 0.006);
  const std::vector<JointStateSample> b = press(kSecond + 3 * kMillisecond, 0.005);
  for (std::size_t i = 0; i < a.size(); ++i) {
    order.emplace_back(0, a[i]);
    order.emplace_back(1, b[i]);
  }
  return order;
}

TEST(JointStatePlayer, ArrivalOrderOfTopicsDoesNotMatter) {
  const auto in_order = twoPresses();
  const auto reference_simulator = twoProbes();
  JointStatePlayer reference_player(*reference_simulator);
  const Trace reference = run(*reference_simulator, reference_player, in_order);
  EXPECT_EQ(reference.stamps.size(), 60U);
  EXPECT_TRUE(std::is_sorted(reference.stamps.begin(), reference.stamps.end()));
  EXPECT_TRUE(reference.pressed());
  for (const int late_topic : {0, 1}) {
    for (const std::size_t lag : {1U, 2U, 4U}) {  // in samples of 10 ms; 5 would be max_gap_s
      std::vector<std::pair<int, JointStateSample>> order;
      std::vector<std::pair<int, JointStateSample>> held;
      for (const auto& entry : in_order) {
        if (entry.first == late_topic) {
          held.push_back(entry);
          if (held.size() <= lag) continue;
          order.push_back(held[held.size() - lag - 1]);
        } else {
          order.push_back(entry);
        }
      }
      order.insert(order.end(), held.end() - static_cast<std::ptrdiff_t>(lag), held.end());
      const auto simulator = twoProbes();
      JointStatePlayer player(*simulator);
      EXPECT_TRUE(run(*simulator, player, order) == reference) << "topic " << late_topic << " late by " << lag;
    }
  }
}

TEST(JointStatePlayer, TwoTopicsLoopTogetherWithOneReset) {
  const auto simulator = twoProbes();
  JointStatePlayer player(*simulator);
  auto order = twoPresses();
  const auto again = order;
  order.insert(order.end(), again.begin(), again.end());
  const Trace trace = run(*simulator, player, order);
  EXPECT_EQ(player.resets(), 1);
  EXPECT_EQ(player.count(Verdict::kAccepted), 120);
  const std::size_t half = trace.forces.size() / 2;
  EXPECT_TRUE(std::equal(trace.forces.begin(), trace.forces.begin() + static_cast<std::ptrdiff_t>(half),
                         trace.forces.begin() + static_cast<std::ptrdiff_t>(half)));
}

TEST(JointStatePlayer, LeftoversOfALoopArePlayedBeforeTheNextOne) {
  const auto simulator = twoProbes();
  JointStatePlayer player(*simulator);
  player.push(0, sample(5 * kSecond, 0.0));
  player.push(1, sample(5 * kSecond, 0.0));
  EXPECT_EQ(drain(player).size(), 2U);
  player.push(0, sample(kSecond, 0.0));  // looped
  EXPECT_TRUE(drain(player).empty());
  player.push(1, sample(5 * kSecond + 10 * kMillisecond, 0.0));  // leftover
  const std::vector<PlayedSample> leftover = drain(player);
  ASSERT_EQ(leftover.size(), 1U);
  EXPECT_EQ(leftover[0].verdict, Verdict::kAccepted);
  EXPECT_FALSE(leftover[0].was_reset);
  player.push(1, sample(kSecond, 0.0));
  const std::vector<PlayedSample> next = drain(player);
  ASSERT_EQ(next.size(), 2U);
  EXPECT_TRUE(next[0].was_reset);
  EXPECT_FALSE(next[1].was_reset);
  EXPECT_EQ(player.resets(), 1);
}

TEST(JointStatePlayer, ATopicFirstHeardInALaterLoopJoinsIt) {
  const auto simulator = twoProbes();
  JointStatePlayer player(*simulator);
  player.push(0, sample(5 * kSecond, 0.0));
  player.push(0, sample(kSecond, 0.0));
  drain(player);
  player.push(1, sample(kSecond + kMillisecond, 0.0));
  player.push(0, sample(kSecond + 2 * kMillisecond, 0.0));
  drain(player);
  EXPECT_EQ(player.count(Verdict::kLate), 0);
  EXPECT_EQ(player.resets(), 1);
  EXPECT_EQ(player.count(Verdict::kAccepted), 3);  // the newest of topic 0 waits
}

TEST(JointStatePlayer, AClockSetBackALittleOnOneTopicKeepsTheOtherOne) {
  const auto simulator = twoProbes();
  JointStatePlayer player(*simulator);
  for (int i = 0; i < 5; ++i) {
    for (const int topic : {0, 1}) player.push(topic, sample(2 * kSecond + i * 10 * kMillisecond, 0.0));
  }
  for (int i = 0; i < 5; ++i) {
    player.push(0, sample(2 * kSecond + (20 + i * 10) * kMillisecond, 0.0));
    player.push(1, sample(2 * kSecond + (50 + i * 10) * kMillisecond, 0.0));
  }
  player.finish();
  drain(player);
  EXPECT_EQ(player.resets(), 1);
  EXPECT_EQ(player.count(Verdict::kLate), 0);
  EXPECT_EQ(player.count(Verdict::kAccepted), 20);
}

TEST(JointStatePlayer, EveryVerdictHasItsOwnText) {
  std::set<std::string> texts;
  for (int v = 0; v < kVerdictCount; ++v) texts.insert(verdictText(static_cast<Verdict>(v)));
  EXPECT_EQ(texts.size(), static_cast<std::size_t>(kVerdictCount));
  EXPECT_EQ(texts.count("unknown"), 0U);
}

}  // namespace
}  // namespace tissue_contact
