/// @file
/// JointStatePlayer saved and restored: the same bits where time goes on, and a gap where it does not.
#include <string>

#include "joint_state_player_fixture.h"
#include "support/refusal.h"

namespace tissue_contact {
namespace joint_state_saved_test {

/// The samples from `from` on; afterwards what was published for them.
Trace goOn(Simulator& simulator, JointStatePlayer& player, const std::vector<JointStateSample>& samples,
           std::size_t from, std::size_t to) {
  Order order;
  for (std::size_t i = from; i < to; ++i) order.emplace_back(0, samples[i]);
  return run(simulator, player, order);
}

class JointStateSaved : public OneProbe {
 protected:
  const std::vector<JointStateSample> samples = press(kSecond, 0.006);
  const std::unique_ptr<Simulator> other = oneProbe();
  JointStatePlayer restored{*other};
};

TEST_F(JointStateSaved, GoesOnToTheSameBits) {
  goOn(*simulator, player, samples, 0, 20);
  restored.restoreState(player.saveState());
  const Trace expected = goOn(*simulator, player, samples, 20, 30);
  EXPECT_TRUE(expected.pressed());
  EXPECT_TRUE(goOn(*other, restored, samples, 20, 30) == expected);
  EXPECT_EQ(restored.gaps(), 0);
}

// The moment that it was saved at, again: its wrench, without a step.
TEST_F(JointStateSaved, TheSameStampIsTheSameMoment) {
  goOn(*simulator, player, samples, 0, 20);
  const Wrench wrench = simulator->wrench(0);
  restored.restoreState(player.saveState());
  const Trace again = goOn(*other, restored, samples, 19, 20);
  ASSERT_EQ(again.stamps.size(), 1U);
  EXPECT_EQ(other->wrench(0).force, wrench.force);
  EXPECT_EQ(other->stepCount(), simulator->stepCount());
}

// A state of yesterday, or of a bag that is played again from its start.
TEST_F(JointStateSaved, AnotherTimeIsAGapAndNoReset) {
  goOn(*simulator, player, samples, 0, 30);
  const std::string state = player.saveState();
  for (const std::int64_t start : {samples.back().stamp_ns - kSecond, samples.back().stamp_ns + 3600 * kSecond}) {
    restored.restoreState(state);
    const std::int64_t gaps = restored.gaps();
    JointStateSample held = samples.back();
    held.stamp_ns = start;
    restored.push(0, held);
    held.stamp_ns += 10 * kMillisecond;
    restored.push(0, held);
    const std::vector<PlayedSample> played = drain(restored);
    ASSERT_EQ(played.size(), 2U);
    EXPECT_TRUE(played[0].was_gap);
    EXPECT_FALSE(played[0].was_reset);
    EXPECT_FALSE(played[1].was_gap);
    EXPECT_EQ(restored.gaps(), gaps + 1);
    EXPECT_GT(other->wrench(0).force.z(), 0.5 * simulator->wrench(0).force.z());
  }
}

/// Without an end, so that what is to wait for another topic waits.
Trace feed(Simulator& simulator, JointStatePlayer& player, const Order& order) {
  Trace trace;
  for (const auto& [topic, s] : order) {
    player.push(topic, s);
    for (const PlayedSample& played : drain(player)) trace.add(played, simulator);
  }
  return trace;
}

// Two arms whose stamps lie between each other's: each moves on the way to its next sample at the other's moments.
TEST(JointStateSavedOfTwo, GoesOnToTheSameBits) {
  const auto first = twoProbes();
  const auto second = twoProbes();
  JointStatePlayer player(*first);
  JointStatePlayer restored(*second);
  const std::vector<JointStateSample> a = press(kSecond, 0.006);
  const std::vector<JointStateSample> b = press(kSecond + 4 * kMillisecond, 0.005);
  const auto order = [&](std::size_t from, std::size_t to) {
    Order all;
    for (std::size_t i = from; i < to; ++i) {
      all.emplace_back(0, a[i]);
      all.emplace_back(1, b[i]);
    }
    return all;
  };
  feed(*first, player, order(0, 15));
  ASSERT_EQ(player.waiting(), 1);  // the last of b, for the next of a
  restored.restoreState(player.saveState());
  const Trace expected = feed(*first, player, order(15, 25));
  EXPECT_TRUE(expected.pressed());
  feed(*second, restored, {{1, b[14]}});
  EXPECT_TRUE(feed(*second, restored, order(15, 25)) == expected);
}

// A jaw whose driver shares the arm's topic, a millisecond behind it: it is on its way when the state is saved.
TEST_F(JointStateSaved, AJointThatIsLateGoesOnItsWayOrIsThereAtAnotherTime) {
  const auto order = [](int from, int to) {
    Order all;
    for (int i = from; i < to; ++i) {
      const std::int64_t stamp = kSecond + i * 10 * kMillisecond;
      all.emplace_back(0, arm(stamp - kMillisecond, 0.0));
      all.emplace_back(0, jaw(stamp, -2e-4 * i));
    }
    return all;
  };
  feed(*simulator, player, order(0, 20));
  const double at = simulator->jointPositions(0).z();
  EXPECT_NEAR(at, -2e-4 * 18.1, 1e-12);
  const std::string state = player.saveState();
  restored.restoreState(state);
  const Trace expected = feed(*simulator, player, order(20, 30));
  EXPECT_TRUE(expected.pressed());
  EXPECT_TRUE(feed(*other, restored, order(20, 30)) == expected);
  for (const std::int64_t start : {kSecond / 2, 3600 * kSecond}) {
    restored.restoreState(state);
    restored.push(0, arm(start, 0.0));
    restored.push(0, arm(start + 10 * kMillisecond, 0.0));
    drain(restored);
    EXPECT_NEAR(other->jointPositions(0).z(), -2e-4 * 19, 1e-12);
  }
}

TEST_F(JointStateSaved, WhatWaitsIsMergedAndCountsAddUp) {
  goOn(*simulator, player, samples, 0, 10);
  const std::string state = player.saveState();
  restored.push(0, samples[0]);
  restored.push(0, samples[1]);
  ASSERT_EQ(restored.waiting(), 2);
  restored.restoreState(state);
  EXPECT_EQ(restored.waiting(), 0);
  EXPECT_EQ(restored.merged(), 2);
}

TEST_F(JointStateSaved, ResetBeginsAnew) {
  const Trace first = goOn(*simulator, player, samples, 0, 30);
  player.reset();
  EXPECT_EQ(simulator->stepCount(), 0);
  EXPECT_TRUE(goOn(*simulator, player, samples, 0, 30) == first);
  EXPECT_EQ(player.resets(), 1);
}

TEST_F(JointStateSaved, RefusesTheStateOfASimulatorAlone) {
  goOn(*simulator, player, samples, 0, 10);
  expectRefusal([&] { restored.restoreState(simulator->saveState()); }, {"saved state"});
  expectRefusal([&] { restored.restoreState(""); }, {"saved state"});
}

}  // namespace joint_state_saved_test
}  // namespace tissue_contact
