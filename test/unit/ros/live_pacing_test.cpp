/// @file
/// How many steps, and until when, the newest joint state may take.
#include "ros/node/live_pacing.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>

#include "ros/node/receipt_times.h"
#include "support/text_scene.h"
#include "tissue_contact/simulation/joint_state_player.h"

namespace tissue_contact {
namespace live_pacing_test {

constexpr double kBound = 0.02;  // s
constexpr double kTiny = 1e-9;   // s: round-off of sums of seconds

/// A machine whose steps cost the same, and a driver that has a new state at any time. Returns the worst lag of the last
/// half of the run, and the length of its last step.
struct Outcome {
  double worst_lag_s = 0.0;
  double step_s = 0.0;
  int most_steps = 0;
};

Outcome run(double step_cost_s, double max_step_s, int intervals) {
  LivePacing pacing(kBound);
  Outcome outcome;
  double now_s = 100.0;
  double played_s = now_s - 0.001;
  for (int i = 0; i < intervals; ++i) {
    const double motion_s = now_s - played_s;
    const int wanted = static_cast<int>(std::ceil(motion_s / max_step_s - 1e-6));
    pacing.begin(now_s, now_s, wanted);
    const int most = pacing.mostSteps();
    const int steps = std::max(1, most > 0 ? std::min(wanted, most) : wanted);
    played_s = now_s;
    for (int k = 0; k < steps; ++k) {
      now_s += step_cost_s;
      pacing.noteStep(now_s);
    }
    outcome.step_s = motion_s / steps;
    outcome.most_steps = std::max(outcome.most_steps, steps);
    if (i > intervals / 2) outcome.worst_lag_s = std::max(outcome.worst_lag_s, now_s - played_s);
  }
  return outcome;
}

TEST(LivePacing, DoesNothingBeforeAStepWasSeen) {
  LivePacing pacing(kBound);
  EXPECT_EQ(pacing.mostSteps(), 0);  // no limit
  EXPECT_EQ(pacing.stepCost(), 0.0);
  pacing.begin(5.0, 5.0, 1);
  EXPECT_GE(pacing.deadline(5.0), 5.0 + 0.5 * kBound);
}

TEST(LivePacing, LeavesAMachineThatKeepsUpAlone) {
  const Outcome outcome = run(0.0005, 0.001, 1000);  // half a millisecond of work per millisecond
  EXPECT_LE(outcome.step_s, 0.001 + kTiny);
  EXPECT_LE(outcome.worst_lag_s, 0.001 + kTiny);
}

TEST(LivePacing, HoldsTheBoundWhereStepsCostMoreThanThereIsTimeFor) {
  for (const double cost_s : {0.0015, 0.002, 0.005, 0.009}) {
    const Outcome outcome = run(cost_s, 0.001, 1000);
    EXPECT_LE(outcome.worst_lag_s, 0.5 * kBound + kTiny) << cost_s;
    // The machine does a step in cost_s, so no shorter step keeps up with time.
    EXPECT_NEAR(outcome.step_s, cost_s, 1e-6) << cost_s;
  }
}

TEST(LivePacing, OneStepIsTakenHoweverMuchItCosts) {
  const Outcome outcome = run(0.05, 0.001, 100);
  EXPECT_NEAR(outcome.worst_lag_s, 0.05, kTiny);  // what the solver's deadline is for
}

TEST(LivePacing, TheDeadlineLeavesStepsThatFollowTheirUsualCost) {
  LivePacing pacing(kBound);
  pacing.begin(10.0, 10.0, 1);
  pacing.noteStep(10.001);  // a step costs 1 ms
  pacing.begin(20.0, 19.999, 5);
  EXPECT_NEAR(pacing.deadline(20.0), 19.999 + 0.9 * kBound - 4 * 0.001, kTiny);
  pacing.noteStep(20.001);
  EXPECT_NEAR(pacing.deadline(20.001), 19.999 + 0.9 * kBound - 3 * 0.001, kTiny);
}

TEST(LivePacing, TheDeadlineLeavesAStepItsUsualCostHoweverLateItIs) {
  LivePacing pacing(kBound);
  pacing.begin(10.0, 10.0, 1);
  pacing.noteStep(10.001);
  pacing.begin(20.0, 19.0, 3);
  EXPECT_NEAR(pacing.deadline(20.0), 20.001, kTiny);
  pacing.begin(30.0, 29.0, 1);
  pacing.noteStep(35.0);  // steps have become far too dear: half the bound
  pacing.begin(40.0, 39.0, 3);
  EXPECT_NEAR(pacing.deadline(40.0), 40.0 + 0.5 * kBound, kTiny);
}

TEST(LivePacing, LearnsFastThatStepsAreDearAndSlowlyThatTheyAreCheap) {
  LivePacing pacing(kBound);
  double now_s = 0.0;
  const auto step = [&](double cost_s) {
    pacing.begin(now_s, now_s, 1);
    now_s += cost_s;
    pacing.noteStep(now_s);
  };
  for (int i = 0; i < 100; ++i) step(0.0001);
  EXPECT_EQ(pacing.mostSteps(), 100);
  for (int i = 0; i < 4; ++i) step(0.005);
  EXPECT_LE(pacing.mostSteps(), 4);
  for (int i = 0; i < 4; ++i) step(0.0001);
  EXPECT_LE(pacing.mostSteps(), 6);
  for (int i = 0; i < 200; ++i) step(0.0001);
  EXPECT_GE(pacing.mostSteps(), 99);
}

/// Two arms at 50 Hz, 1 ms apart, each with a topic of its own: the second's state has the other's next one 19 ms later,
/// and its own next 20 ms later, to wait for. Runs what the node's stepping thread does, on an artificial
/// clock. @return the largest lag of a wrench behind the receipt of its state.
double worstLagOfTwoArms(double step_cost_s, int& wrenches) {
  Simulator simulator =
      makeSimulator(blockScene() + "instruments:\n" + probeEntry("a", "/a", "[-0.015, 0, 0.5]") +
                    probeEntry("b", "/b", "[0.015, 0, 0.5]") + "step: {max_step_s: 0.001, max_lag_s: 0.02}\n");
  JointStatePlayer player(simulator);
  player.setPolicy(StatePolicy::kNewestState);
  ReceiptTimes receipts(2);
  LivePacing pacing(kBound);
  double now_s = 100.0;
  int next = 0;
  double worst_s = 0.0;
  const auto arrival = [](int i) { return 100.0 + 0.02 * (i / 2) + 0.001 * (i % 2); };
  while (next < 200) {
    // Waits: for the next state, or until the earliest has waited long enough.
    double until_s = arrival(next);
    if (const auto earliest = player.earliestStamp()) {
      const double patience_s = std::max(now_s, pacing.waitUntil(receipts.find(*earliest)->received_s));
      if (patience_s < until_s) {
        until_s = patience_s;
        player.stopWaiting();
      }
    }
    now_s = std::max(now_s, until_s);
    for (; next < 200 && arrival(next) <= now_s; ++next) {
      const auto stamp_ns = static_cast<std::int64_t>(1e9 * arrival(next));
      receipts.note(next % 2, {stamp_ns, arrival(next)});
      player.push(next % 2, {stamp_ns, {"z"}, {0.0}});
    }
    while (const auto stamp_ns = player.nextStamp()) {
      pacing.begin(now_s, receipts.find(*stamp_ns)->received_s, 20);
      const int steps = pacing.mostSteps() > 0 ? std::min(20, pacing.mostSteps()) : 1;
      player.setLimits({1, nullptr});
      const auto played = player.playNext();
      for (int k = 0; k < steps; ++k) {
        now_s += step_cost_s;
        pacing.noteStep(now_s);
      }
      if (!played || played->instruments.empty()) continue;
      wrenches += static_cast<int>(played->instruments.size());
      worst_s = std::max(worst_s, now_s - receipts.take(*stamp_ns)->received_s);
    }
  }
  return worst_s;
}

TEST(LivePacing, TwoArmsThatWaitForEachOtherKeepTheBoundInSum) {
  for (const double cost_s : {0.0005, 0.001, 0.0024, 0.005, 0.0099}) {
    int wrenches = 0;
    EXPECT_LE(worstLagOfTwoArms(cost_s, wrenches), kBound) << cost_s;
    EXPECT_GT(wrenches, 90) << cost_s;
  }
}

/// A driver of 1 kHz until `now_s`, and steps of this cost.
void drive(LivePacing& pacing, double& now_s, double step_cost_s, int states) {
  for (int i = 0; i < states; ++i) {
    now_s += 0.001;
    pacing.notePlayed(now_s);
    pacing.begin(now_s, now_s, 1);
    pacing.noteStep(now_s + step_cost_s);
  }
}

TEST(LivePacing, ADearStepEndsWhenTheNextStateIsDue) {
  LivePacing pacing(kBound);
  double now_s = 10.0;
  EXPECT_TRUE(std::isinf(pacing.promptDeadline(now_s)));  // nothing is known
  drive(pacing, now_s, 0.0005, 500);
  pacing.begin(now_s, now_s, 1);
  EXPECT_NEAR(pacing.promptDeadline(now_s), now_s + 0.0008, 1e-6);
  EXPECT_LT(pacing.promptDeadline(now_s), pacing.deadline(now_s));
  // One that waited for a step gets what steps cost in the mean, so that the wait shrinks.
  EXPECT_NEAR(pacing.promptDeadline(now_s + 0.0006), now_s + 0.0011, 1e-6);
  pacing.begin(now_s, now_s, 2);  // both are to be done by then: too much
  EXPECT_TRUE(std::isinf(pacing.promptDeadline(now_s)));
}

/// What the node's stepping thread does with receipts: two arms send every stamp within 10 us, and states that are refused
/// come in between.
TEST(LivePacing, AMomentOfTwoTopicsAndRefusedStatesIsOneMoment) {
  LivePacing pacing(kBound);
  ReceiptTimes receipts(2);
  double now_s = 10.0;
  for (int i = 1; i <= 500; ++i) {
    now_s += 0.001;
    const std::int64_t stamp_ns = 1000000LL * i;
    for (const int topic : {0, 1}) receipts.note(topic, {stamp_ns, now_s + 1e-5 * topic});
    receipts.note(0, {stamp_ns - 500, now_s + 0.0003});  // late, so never played
    if (const auto receipt = receipts.take(stamp_ns)) pacing.notePlayed(receipt->received_s);
    pacing.begin(now_s, now_s, 1);
    pacing.noteStep(now_s + 0.0005);
  }
  pacing.begin(now_s, now_s, 1);
  EXPECT_NEAR(pacing.promptDeadline(now_s), now_s + 0.0008, 1e-6);
}

/// Of two topics the one that came first may be played last.
TEST(LivePacing, ReceiptsOutOfOrderDoNotAddTime) {
  LivePacing pacing(kBound);
  double now_s = 10.0;
  for (int i = 0; i < 1000; ++i) {
    now_s += 0.001;
    pacing.notePlayed(now_s + (i % 2 == 0 ? 0.0 : -0.003));
    pacing.begin(now_s, now_s, 1);
    pacing.noteStep(now_s + 0.0005);
  }
  pacing.begin(now_s, now_s, 1);
  EXPECT_LT(pacing.promptDeadline(now_s), now_s + 0.0009);  // 0.8 of 1 ms and some for the running mean
}

TEST(LivePacing, ADriverThatPausesIsStillTakenForFast) {
  LivePacing pacing(kBound);
  double now_s = 10.0;
  drive(pacing, now_s, 0.0005, 500);
  now_s += 3600.0;
  drive(pacing, now_s, 0.0005, 1);
  EXPECT_LT(pacing.promptDeadline(now_s), now_s + 0.0012);
}

TEST(LivePacing, WhereStepsFillTheTimeOnlyTheBoundCounts) {
  LivePacing pacing(kBound);
  double now_s = 10.0;
  drive(pacing, now_s, 0.0009, 500);
  EXPECT_TRUE(std::isinf(pacing.promptDeadline(now_s)));
}

}  // namespace live_pacing_test
}  // namespace tissue_contact
