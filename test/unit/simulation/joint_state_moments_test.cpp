/// @file
/// JointStatePlayer where topics give one moment together: interpolation, and topics that only update joints.
#include <algorithm>
#include <array>
#include <cstddef>
#include <random>
#include <string>
#include <utility>

#include "joint_state_player_fixture.h"

namespace tissue_contact {
namespace joint_state_moments_test {

/// x and y on the arm's topic, z on the jaw's.
std::unique_ptr<Simulator> armAndJaw() { return blockTouchedBy(probe("a", "/a/measured_js, /a/jaw/measured_js", 0.0)); }

TEST_F(TwoProbes, AnInstrumentSampledBetweenAnothersStampsMovesEvenly) {
  const double speed = 0.1;  // m/s, upwards
  const auto height = [&](std::int64_t stamp_ns) { return speed * 1e-9 * static_cast<double>(stamp_ns - kSecond); };
  int moments = 0;
  for (int i = 0; i < 10; ++i) {
    const std::int64_t a = kSecond + i * 10 * kMillisecond;
    const std::int64_t b = a + 3 * kMillisecond;
    player.push(0, sample(a, height(a)));
    player.push(1, sample(b, height(b)));
    while (const auto played = player.playNext()) {
      ++moments;
      ASSERT_EQ(played->instruments.size(), 1U);
      EXPECT_EQ(simulator->jointPositions(played->instruments[0]).z(), height(played->stamp_ns));
      if (played->stamp_ns == kSecond) continue;  // nothing of the other yet
      const int other = 1 - played->instruments[0];
      // Round-off alone, of joints that move a centimetre.
      EXPECT_NEAR(simulator->jointPositions(other).z(), height(played->stamp_ns), 1e-15);
    }
  }
  EXPECT_EQ(moments, 19);  // the last of b waits
}

TEST_F(TwoProbes, NothingIsInterpolatedOverMoreThanMaxGap) {
  player.push(1, sample(kSecond, 0.001));
  player.push(1, sample(kSecond + 51 * kMillisecond, 0.002));
  for (const int ms : {0, 20, 40, 60}) player.push(0, sample(kSecond + ms * kMillisecond, 0.0));
  std::vector<double> heights;
  while (player.playNext()) heights.push_back(simulator->jointPositions(1).z());
  ASSERT_EQ(heights.size(), 4U);  // 60 ms waits
  for (const int k : {0, 1, 2}) EXPECT_EQ(heights[k], 0.001);
  EXPECT_NEAR(heights[3], 0.001 + 0.001 * 11.0 / 50.0, 1e-15);  // the way takes max_gap_s
}

TEST(JointStateMoments, TheOrderOfTopicsInTheSceneDoesNotMatter) {
  std::vector<Trace> traces;
  for (const char* topics : {"/arm, /wrist", "/wrist, /arm"}) {
    const auto simulator = blockTouchedBy(probe("a", topics, 0.0));
    JointStatePlayer player(*simulator);
    const bool arm_first = player.topics()[0] == "/arm";
    Order order;
    for (int i = 0; i < 30; ++i) {
      const std::int64_t stamp = kSecond + i * 10 * kMillisecond;
      order.emplace_back(arm_first ? 0 : 1, arm(stamp, 1e-4 * i));
      order.emplace_back(arm_first ? 1 : 0, jaw(stamp, -2e-4 * i));
    }
    traces.push_back(runAll(*simulator, player, order));
    EXPECT_EQ(traces.back().stamps.size(), 30U);
    EXPECT_EQ(traces.back().forces.size(), 30U * 6U);
  }
  EXPECT_TRUE(traces[0].pressed());
  EXPECT_TRUE(traces[0] == traces[1]);
}

TEST(JointStateMoments, AJawBesideItsArmOnlyUpdates) {
  const auto simulator = armAndJaw();
  JointStatePlayer player(*simulator);
  EXPECT_TRUE(player.triggers(0));
  EXPECT_FALSE(player.triggers(1));
  player.push(1, jaw(kSecond - 2 * kMillisecond, 0.001));
  player.push(1, jaw(kSecond - kMillisecond, 0.002));
  EXPECT_TRUE(drain(player).empty());
  player.push(0, arm(kSecond, 0.001));
  player.push(1, jaw(kSecond + 4 * kMillisecond, 0.003));
  std::vector<PlayedSample> played = drain(player);
  ASSERT_EQ(played.size(), 1U);
  EXPECT_EQ(played[0].stamp_ns, kSecond);
  EXPECT_EQ(played[0].topic, 0);
  EXPECT_EQ(played[0].accepted, 3);
  EXPECT_EQ(played[0].instruments, std::vector<int>{0});
  // First heard: placed, at the newest position; from then on a fifth of the way from -1 ms to 4 ms.
  EXPECT_NEAR(simulator->jointPositions(0).z(), 0.0022, 1e-15);
  player.push(0, arm(kSecond + 10 * kMillisecond, 0.002));
  EXPECT_TRUE(drain(player).empty());  // waits for the jaw
  player.push(1, jaw(kSecond + 14 * kMillisecond, 0.013));
  played = drain(player);
  ASSERT_EQ(played.size(), 1U);
  EXPECT_EQ(played[0].stamp_ns, kSecond + 10 * kMillisecond);
  EXPECT_EQ(simulator->stepCount(), 10);
  EXPECT_NEAR(simulator->jointPositions(0).z(), 0.003 + 0.6 * 0.010, 1e-15);
  EXPECT_EQ(player.waiting(), 1);  // the jaw's newest, for the arm's next
}

TEST(JointStateMoments, TellsHowFarAJawIsAheadAndForHowLongItSaidNothing) {
  const auto simulator = armAndJaw();
  JointStatePlayer player(*simulator);
  EXPECT_EQ(player.lead_s(1), 0.0);
  EXPECT_FALSE(player.idle_s(1));
  player.push(1, jaw(kSecond + kMillisecond, 0.001));
  EXPECT_EQ(player.lead_s(1), 0.0) << "nothing to compare with";
  player.push(0, arm(kSecond + kMillisecond, 0.0));
  drain(player);
  EXPECT_EQ(player.lead_s(1), 0.0);
  EXPECT_EQ(player.idle_s(1), 0.0);
  for (int i = 1; i <= 15; ++i) {
    player.push(1, jaw(10 * kSecond + i * 10 * kMillisecond, 0.002));
    player.push(0, arm(kSecond + (1 + i * 10) * kMillisecond, 0.0));
  }
  player.finish();
  drain(player);
  EXPECT_NEAR(player.lead_s(1), 8.999, 1e-9);
  EXPECT_EQ(player.lead_s(0), 0.0) << "it triggers";
  EXPECT_NEAR(player.idle_s(1).value(), 0.15, 1e-9);
  player.reset();
  EXPECT_FALSE(player.idle_s(1));
}

TEST(JointStateMoments, APauseOfAllTopicsIsNoSilenceOfAJaw) {
  const auto simulator = armAndJaw();
  JointStatePlayer player(*simulator);
  const auto both = [&](std::int64_t stamp_ns) {
    player.push(1, jaw(stamp_ns, 0.001));
    player.push(0, arm(stamp_ns, 0.0));
  };
  both(kSecond);
  both(kSecond + 10 * kMillisecond);
  player.push(0, arm(10 * kSecond, 0.0));  // the jaw's comes a little later
  player.finish();
  drain(player);
  EXPECT_EQ(player.gaps(), 1);
  EXPECT_EQ(player.idle_s(1), 0.0);
}

TEST(JointStateMoments, AJawThatTriggersGivesWrenchesOfItsOwn) {
  const auto simulator = blockTouchedBy(probe("a", "/a/measured_js, {topic: /a/jaw/measured_js, triggers: true}", 0.0));
  JointStatePlayer player(*simulator);
  Order order;
  for (int i = 0; i < 5; ++i) {
    order.emplace_back(0, arm(kSecond + i * 10 * kMillisecond, 0.0));
    order.emplace_back(1, jaw(kSecond + (i * 10 + 4) * kMillisecond, 0.0));
  }
  EXPECT_EQ(runAll(*simulator, player, order).forces.size(), 10U * 6U);
}

TEST(JointStateMoments, AJawThatIsNeverHeardDelaysOnlyTheStart) {
  const auto simulator = armAndJaw();
  JointStatePlayer player(*simulator);
  std::vector<std::size_t> played;
  for (int i = 0; i < 15; ++i) {
    player.push(0, arm(kSecond + i * 10 * kMillisecond, 0.0));
    played.push_back(drain(player).size());
  }
  EXPECT_EQ(played, (std::vector<std::size_t>{0, 0, 0, 0, 0, 6, 1, 1, 1, 1, 1, 1, 1, 1, 1}));  // max_gap_s is 50 ms
}

TEST(JointStateMoments, AJawThatFallsSilentIsWaitedForAgainWhenItComesBack) {
  const auto simulator = armAndJaw();
  JointStatePlayer player(*simulator);
  std::int64_t stamp = kSecond;
  player.push(1, jaw(stamp, 0.001));
  for (int i = 0; i < 15; ++i) player.push(0, arm(stamp += 10 * kMillisecond, 0.0));
  drain(player);
  EXPECT_EQ(player.waiting(), 0);
  player.push(1, jaw(stamp + kMillisecond, 0.002));
  player.push(0, arm(stamp += 10 * kMillisecond, 0.0));
  EXPECT_TRUE(drain(player).empty());
  player.push(1, jaw(stamp, 0.002));
  EXPECT_EQ(drain(player).size(), 1U);
  EXPECT_NEAR(simulator->jointPositions(0).z(), 0.001 + 0.001 * 10.0 / 50.0, 1e-15);  // the way takes max_gap_s
}

TEST(JointStateMoments, AnOvertakenJawIsTakenAtTheNextMoment) {
  const auto simulator = armAndJaw();
  JointStatePlayer player(*simulator);
  for (int i = 0; i < 11; ++i) player.push(0, arm(kSecond + i * 10 * kMillisecond, 0.0));
  drain(player);
  player.push(1, jaw(kSecond, 0.003));  // far behind: not waited for any longer
  player.push(0, arm(kSecond + 110 * kMillisecond, 0.0));
  player.push(0, arm(kSecond + 170 * kMillisecond, 0.0));
  for (const PlayedSample& played : drain(player)) EXPECT_EQ(played.verdict, Verdict::kAccepted);
  EXPECT_EQ(simulator->jointPositions(0).z(), 0.003);
}

TEST(JointStateMoments, AJawAloneMovesNothingAndItsQueueIsBounded) {
  const auto simulator = armAndJaw();
  JointStatePlayer player(*simulator);
  const auto many = static_cast<std::int64_t>(JointStatePlayer::kMaxWaiting);
  for (std::int64_t i = 0; i < many + 5; ++i) {
    player.push(1, jaw(kSecond + i * kMillisecond, 0.001));
    EXPECT_TRUE(drain(player).empty());
  }
  EXPECT_EQ(player.waiting(), many);
  EXPECT_EQ(player.merged(), 5);
  EXPECT_EQ(simulator->stepCount(), 0);
  player.push(0, arm(kSecond + many * kMillisecond, 0.0));
  EXPECT_EQ(drain(player).size(), 1U);
  EXPECT_EQ(simulator->jointPositions(0).z(), 0.001);
}

TEST(JointStateMoments, AJawLoopsWithItsArm) {
  const auto simulator = armAndJaw();
  JointStatePlayer player(*simulator);
  Order order;
  for (int loop = 0; loop < 3; ++loop) {
    for (int i = 0; i < 30; ++i) {
      order.emplace_back(1, jaw(kSecond + i * 10 * kMillisecond, -2e-4 * i));
      order.emplace_back(0, arm(kSecond + (i * 10 + 1) * kMillisecond, 1e-4 * i));
    }
  }
  const Trace trace = runAll(*simulator, player, order);
  EXPECT_EQ(player.resets(), 2);
  ASSERT_EQ(trace.forces.size(), 3U * 30U * 6U);
  EXPECT_TRUE(trace.pressed());
  // The last moment of a loop is without the jaw's next, which the others' next loop holds: both hold it.
  EXPECT_TRUE(std::equal(trace.forces.begin(), trace.forces.begin() + 180, trace.forces.begin() + 180));
  EXPECT_TRUE(std::equal(trace.forces.begin(), trace.forces.begin() + 180, trace.forces.begin() + 360));
}

/// Three topics of different rates, played twice as a looped bag, each sample up to 39 ms late: with the longest interval
/// between stamps, 10 ms, less than max_gap_s, 50 ms.
TEST(JointStateMoments, NoOrderOfArrivalMattersWithinMaxGap) {
  struct Arrival {
    std::int64_t time_ns;
    int topic;
    JointStateSample sample;
  };
  const auto play = [](unsigned seed, std::int64_t& resets) {
    std::mt19937 random(seed);
    std::vector<Arrival> arrivals;
    const std::int64_t length = 300 * kMillisecond;
    const std::array<std::int64_t, 3> periods = {10 * kMillisecond, 4 * kMillisecond, 7 * kMillisecond};
    for (int topic = 0; topic < 3; ++topic) {
      std::int64_t before = 0;
      for (std::int64_t t = (3 - topic) % 3 * kMillisecond; t < 2 * length;
           t += periods[static_cast<std::size_t>(topic)]) {
        const std::int64_t stamp = kSecond + t % length;
        const std::int64_t delay = seed == 0 ? 0 : static_cast<std::int64_t>(random() % 40) * kMillisecond;
        before = std::max(before, t + delay);
        const double way = 1e-9 * static_cast<double>(t % length);
        const JointStateSample s = topic == 0   ? arm(stamp, 0.01 * way)
                                   : topic == 1 ? jaw(stamp, -0.02 * way)
                                                : sample(stamp, -0.015 * way);
        arrivals.push_back({before, topic, s});
      }
    }
    std::stable_sort(arrivals.begin(), arrivals.end(),
                     [](const Arrival& a, const Arrival& b) { return a.time_ns < b.time_ns; });
    Order order;
    for (const Arrival& arrival : arrivals) order.emplace_back(arrival.topic, arrival.sample);
    const auto simulator =
        blockTouchedBy(probe("a", "/a/measured_js, /a/jaw/measured_js", -0.015) + probe("b", "/b", 0.015));
    JointStatePlayer player(*simulator);
    Trace trace = runAll(*simulator, player, order);
    resets = player.resets();
    return trace;
  };
  std::int64_t resets = 0;
  const Trace reference = play(0, resets);
  EXPECT_TRUE(reference.pressed());
  EXPECT_EQ(resets, 1);
  for (unsigned seed = 1; seed <= 10; ++seed) {
    EXPECT_TRUE(play(seed, resets) == reference) << seed;
    EXPECT_EQ(resets, 1) << seed;
  }
}

// Nothing is known of its way there: a jaw that is heard late may throw what it should hold.
TEST(JointStateMoments, AJointHeardOnceTheRunHasBegunIsToldOf) {
  const auto simulator = armAndJaw();
  JointStatePlayer player(*simulator);
  std::vector<std::string> told;
  for (int i = 0; i < 40; ++i) {
    const std::int64_t stamp = kSecond + i * 10 * kMillisecond;
    player.push(0, arm(stamp, 0.0));
    if (i >= 30) player.push(1, jaw(stamp, -0.001));
    player.stopWaiting();
    while (const auto played = player.playNext()) {
      if (!played->placed.empty()) told.push_back(played->placed);
    }
  }
  ASSERT_EQ(told.size(), 1U);
  EXPECT_NE(told[0].find("'z' of 'a' is heard for the first time and goes from 0 to -0.001 at once"), std::string::npos)
      << told[0];
}

}  // namespace joint_state_moments_test
}  // namespace tissue_contact
