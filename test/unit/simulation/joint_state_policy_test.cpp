/// @file
/// JointStatePlayer's policies: newest state beside every state, bounds on an advance, and counts that add up.
#include <limits>
#include <random>
#include <stdexcept>
#include <utility>

#include "joint_state_player_fixture.h"

namespace tissue_contact {
namespace joint_state_policy_test {

/// A press of one probe, `batch` samples at a time.
Trace pressInBatches(StatePolicy policy, std::size_t batch, std::int64_t& merged) {
  const auto simulator = oneProbe();
  JointStatePlayer player(*simulator);
  player.setPolicy(policy);
  Trace trace;
  const std::vector<JointStateSample> samples = press(kSecond, 0.006);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    player.push(0, samples[i]);
    if (i % batch != 0 && i + 1 < samples.size()) continue;
    while (const auto played = player.playNext()) trace.add(*played, *simulator);
  }
  EXPECT_EQ(simulator->stepCount(), 290);
  EXPECT_EQ(player.count(Verdict::kAccepted) + player.merged(), 30);
  merged = player.merged();
  return trace;
}

TEST_F(OneProbe, AutoHasToBeDecidedByTheCaller) {
  EXPECT_EQ(player.policy(), StatePolicy::kEveryState);
  EXPECT_THROW(player.setPolicy(StatePolicy::kAuto), std::invalid_argument);
}

TEST(JointStatePolicy, NewestStateIsEveryStateForWhoKeepsUp) {
  std::int64_t merged = 0;
  const Trace every = pressInBatches(StatePolicy::kEveryState, 1, merged);
  EXPECT_TRUE(every.pressed());
  EXPECT_TRUE(every == pressInBatches(StatePolicy::kNewestState, 1, merged));
  EXPECT_EQ(merged, 0);
}

TEST(JointStatePolicy, NewestStatePlaysStraightToTheNewestAndMergesTheRest) {
  std::int64_t merged = 0;
  const Trace every = pressInBatches(StatePolicy::kEveryState, 1, merged);
  const Trace newest = pressInBatches(StatePolicy::kNewestState, 4, merged);
  ASSERT_EQ(newest.stamps.size(), 9U);  // samples 0, 4, 8 to 28, and the last
  EXPECT_EQ(merged, 21);
  EXPECT_EQ(newest.stamps[1], kSecond + 40 * kMillisecond);
  // The press is even and steps are 1 ms either way, so that the merged motion is the same up to round-off; what that
  // moves within the solver's tolerance is far less than a per cent of the force.
  const double expected = every.forces[every.forces.size() - 4];
  EXPECT_GT(std::abs(expected), 0.01);
  EXPECT_NEAR(newest.forces[newest.forces.size() - 4], expected, 0.01 * std::abs(expected));
}

TEST_F(OneProbe, AMomentSaysHowManyWereMerged) {
  player.setPolicy(StatePolicy::kNewestState);
  for (int i = 0; i < 4; ++i) player.push(0, sample(kSecond + i * 10 * kMillisecond, -0.001 * i));
  std::vector<PlayedSample> played = drain(player);
  ASSERT_EQ(played.size(), 1U);
  EXPECT_EQ(played[0].accepted, 1);
  EXPECT_EQ(played[0].merged, 3);
  EXPECT_EQ(played[0].stamp_ns, kSecond + 30 * kMillisecond);
  EXPECT_EQ(simulator->jointPositions(0).z(), -0.003);  // the first moment: placed at the newest, no step
  EXPECT_EQ(simulator->stepCount(), 0);
  for (int i = 4; i < 7; ++i) player.push(0, sample(kSecond + i * 10 * kMillisecond, -0.001 * i));
  played = drain(player);
  ASSERT_EQ(played.size(), 1U);
  EXPECT_EQ(played[0].merged, 2);
  EXPECT_EQ(simulator->stepCount(), 30);
  EXPECT_EQ(player.merged(), 5);
  EXPECT_EQ(player.count(Verdict::kAccepted), 2);
}

TEST_F(TwoProbes, NewestStateWaitsForATopicNoLongerThanAQuarterOfMaxLag) {
  player.setPolicy(StatePolicy::kNewestState);
  player.push(1, sample(kSecond, 0.0));
  player.push(0, sample(kSecond, 0.0));
  EXPECT_EQ(drain(player).size(), 1U);
  player.push(0, sample(kSecond + 2 * kMillisecond, 0.0));
  player.push(0, sample(kSecond + 4 * kMillisecond, 0.0));
  EXPECT_TRUE(drain(player).empty());
  EXPECT_FALSE(player.nextStamp());
  EXPECT_EQ(player.earliestStamp(), kSecond + 2 * kMillisecond);
  player.push(0, sample(kSecond + 5 * kMillisecond, 0.0));  // max_lag_s is 20 ms
  EXPECT_EQ(player.nextStamp(), kSecond + 5 * kMillisecond);
  const std::vector<PlayedSample> played = drain(player);
  ASSERT_EQ(played.size(), 1U);
  EXPECT_EQ(played[0].stamp_ns, kSecond + 5 * kMillisecond);
  EXPECT_EQ(played[0].merged, 2);
  EXPECT_EQ(played[0].instruments, std::vector<int>{0});
}

TEST_F(TwoProbes, WhoeverHasAClockMayEndTheWait) {
  player.setPolicy(StatePolicy::kNewestState);
  for (const int topic : {0, 1}) player.push(topic, sample(kSecond, 0.0));
  EXPECT_EQ(drain(player).size(), 1U);
  EXPECT_FALSE(player.earliestStamp());
  player.push(0, sample(kSecond + kMillisecond, 0.0));
  EXPECT_TRUE(drain(player).empty());
  player.stopWaiting();
  EXPECT_EQ(player.nextStamp(), kSecond + kMillisecond);
  EXPECT_EQ(drain(player).size(), 1U);
  player.push(0, sample(kSecond + 2 * kMillisecond, 0.0));
  EXPECT_TRUE(drain(player).empty());  // that held for those that were here
}

TEST_F(TwoProbes, AnInstrumentThatIsAlwaysBehindStillMovesAndHasItsWrench) {
  player.setPolicy(StatePolicy::kNewestState);
  int owed = 0;
  for (int i = 0; i < 30; ++i) {
    player.push(0, sample(kSecond + i * 10 * kMillisecond, 0.0));
    if (i >= 5) player.push(1, sample(kSecond + (i - 5) * 10 * kMillisecond, 1e-4 * i));
    for (const PlayedSample& played : drain(player)) {
      EXPECT_EQ(played.verdict, Verdict::kAccepted);
      owed += static_cast<int>(std::count(played.instruments.begin(), played.instruments.end(), 1));
    }
  }
  EXPECT_GT(owed, 20);
  EXPECT_GT(simulator->jointPositions(1).z(), 0.0025);
}

TEST(JointStatePolicy, NewestStateDoesNotWaitForAJaw) {
  const auto simulator = blockTouchedBy(probe("a", "/a/measured_js, /a/jaw/measured_js", 0.0));
  JointStatePlayer player(*simulator);
  player.setPolicy(StatePolicy::kNewestState);
  player.push(0, {kSecond, {"x"}, {0.0}});
  EXPECT_EQ(drain(player).size(), 1U);
  player.push(1, {kSecond + kMillisecond, {"z"}, {0.004}});
  player.push(0, {kSecond + 10 * kMillisecond, {"x"}, {0.001}});
  EXPECT_EQ(drain(player).size(), 1U);
  EXPECT_EQ(simulator->jointPositions(0), Vector3(0.001, 0.0, 0.004));
}

TEST_F(OneProbe, NewestStateLoops) {
  player.setPolicy(StatePolicy::kNewestState);
  player.push(0, sample(2 * kSecond, 0.0));
  drain(player);
  player.push(0, sample(2 * kSecond + 10 * kMillisecond, 0.0));  // merged into a motion that the loop cuts off
  player.push(0, sample(kSecond, 0.001));
  player.push(0, sample(kSecond + 10 * kMillisecond, 0.0015));
  player.push(0, sample(kSecond + 20 * kMillisecond, 0.002));
  const std::vector<PlayedSample> played = drain(player);
  ASSERT_EQ(played.size(), 1U);
  EXPECT_TRUE(played[0].was_reset);
  EXPECT_EQ(played[0].merged, 3);
  EXPECT_EQ(simulator->jointPositions(0).z(), 0.002);
}

TEST_F(OneProbe, AnInterruptedMomentOwesNothingAndTheNextGoesOnFromThere) {
  player.push(0, sample(kSecond, 0.0));
  drain(player);
  player.setLimits({0, [&] { return simulator->stepCount() == 4; }});
  player.push(0, sample(kSecond + 10 * kMillisecond, -0.001));
  std::vector<PlayedSample> played = drain(player);
  ASSERT_EQ(played.size(), 1U);
  EXPECT_TRUE(played[0].interrupted);
  EXPECT_TRUE(played[0].instruments.empty());
  EXPECT_EQ(played[0].stamp_ns, kSecond + 4 * kMillisecond);
  EXPECT_NEAR(simulator->jointPositions(0).z(), -0.0004, 1e-15);
  player.setLimits({});
  player.push(0, sample(kSecond + 20 * kMillisecond, -0.001));
  played = drain(player);
  ASSERT_EQ(played.size(), 1U);
  EXPECT_EQ(played[0].instruments, std::vector<int>{0});
  EXPECT_EQ(simulator->stepCount(), 20);
  EXPECT_EQ(player.merged(), 1);
  EXPECT_EQ(player.count(Verdict::kAccepted), 2);
}

TEST_F(OneProbe, LimitsBoundTheStepsOfEachMoment) {
  player.setLimits({3, nullptr});
  for (int i = 0; i < 5; ++i) player.push(0, sample(kSecond + i * 10 * kMillisecond, 0.0));
  drain(player);
  EXPECT_EQ(simulator->stepCount(), 12);
}

/// Random topics, stamps and contents, among them all that is refused.
TEST(JointStatePolicy, CountsAddUpToWhatWasPushed) {
  for (const StatePolicy policy : {StatePolicy::kEveryState, StatePolicy::kNewestState}) {
    const auto simulator =
        blockTouchedBy(probe("a", "/a/measured_js, /a/jaw/measured_js", -0.015) + probe("b", "/b", 0.015));
    JointStatePlayer player(*simulator);
    player.setPolicy(policy);
    std::mt19937 random(7);
    std::int64_t pushed = 0;
    std::int64_t now = kSecond;
    std::int64_t moments = 0;
    for (int i = 0; i < 600; ++i) {
      const auto dice = random() % 40;
      now += dice == 0 ? -200 * kMillisecond : 3 * kMillisecond;
      if (dice == 1) player.restart();
      JointStateSample s = sample(now - static_cast<std::int64_t>(random() % 8) * kMillisecond, 0.001);
      if (dice == 2) s.positions[2] = std::numeric_limits<double>::quiet_NaN();
      if (dice == 3) s.names.clear();
      player.push(static_cast<int>(random() % 3), s);
      ++pushed;
      EXPECT_EQ(countedBy(player), pushed);
      if (random() % 4 != 0) continue;
      while (const auto played = player.playNext()) {
        EXPECT_EQ(countedBy(player), pushed);
        moments += static_cast<int>(played->verdict == Verdict::kAccepted);
      }
    }
    EXPECT_GT(moments, 20);
    for (const Verdict v : {Verdict::kLate, Verdict::kNotFinite, Verdict::kBadLength}) EXPECT_GT(player.count(v), 0);
    EXPECT_GT(player.resets(), 0);
    EXPECT_EQ(player.merged() > 0, policy == StatePolicy::kNewestState);
  }
}

/// Of two arms one sends a stamp an hour ahead and no more: what the other sends is behind the simulation from then on. It waited without end, and
/// nobody was told.
TEST_F(TwoProbes, ClockFarAheadOfAnArmThatFallsSilentLeavesNothingWaiting) {
  player.setPolicy(StatePolicy::kNewestState);
  for (int k = 1; k <= 10; ++k) {
    player.push(0, sample(k * 10 * kMillisecond, 0.0));
    player.push(1, sample(k * 10 * kMillisecond, 0.0));
  }
  drain(player);
  player.push(0, sample(3600 * kSecond, 0.0));
  player.stopWaiting();
  drain(player);
  std::string told;
  for (int k = 11; k <= 500; ++k) {
    player.push(1, sample(k * 10 * kMillisecond, -0.001));
    for (const PlayedSample& played : drain(player)) {
      EXPECT_EQ(played.verdict, Verdict::kLate);
      told = played.detail;
    }
    ASSERT_LE(player.waiting(), 6) << k;  // 50 ms of them: max_gap_s
  }
  EXPECT_GT(player.count(Verdict::kLate), 400);
  EXPECT_NE(told.find("the simulation is already at 3600.000000000 s, where stamps of another topic have taken it"),
            std::string::npos)
      << told;
  const std::int64_t merged = player.merged();
  player.push(0, sample(3600 * kSecond + 10 * kMillisecond, 0.0));  // goes on after all: takes along what waits
  player.stopWaiting();
  drain(player);
  EXPECT_GT(player.merged(), merged);
  EXPECT_EQ(player.waiting(), 0);
}

}  // namespace joint_state_policy_test
}  // namespace tissue_contact
