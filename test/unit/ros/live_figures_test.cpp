/// @file
/// What a live run says of itself: the policy, the lag and its bound, the real-time factor, the advice and the counts.
#include "ros/node/live_figures.h"

#include <gtest/gtest.h>

#include <vector>

#include "ros/node/joint_state_policy.h"
#include "ros/node/real_time_factor.h"
#include "support/refusal.h"

namespace tissue_contact {
namespace live_figures_test {

TEST(JointStatePolicy, TheSceneHasTheLastWord) {
  for (const bool simulated_time : {false, true}) {
    for (const double age_s : {0.0, 1e9}) {
      EXPECT_EQ(choosePolicy(StatePolicy::kEveryState, simulated_time, age_s).policy, StatePolicy::kEveryState);
      EXPECT_EQ(choosePolicy(StatePolicy::kNewestState, simulated_time, age_s).policy, StatePolicy::kNewestState);
    }
  }
}

TEST(JointStatePolicy, AutoFollowsTheClock) {
  const auto choose = [](bool simulated_time, double age_s) {
    return choosePolicy(StatePolicy::kAuto, simulated_time, age_s).policy;
  };
  EXPECT_EQ(choose(true, 0.001), StatePolicy::kEveryState);
  EXPECT_EQ(choose(false, 0.001), StatePolicy::kNewestState);
  EXPECT_EQ(choose(false, -0.5), StatePolicy::kNewestState);
  EXPECT_EQ(choose(false, 1.5e9), StatePolicy::kEveryState);
  EXPECT_EQ(choose(false, -1.5), StatePolicy::kEveryState);
}

/// The policies chosen, in turn, by states of these ages received every 10 ms.
std::vector<StatePolicy> chosen(PolicyChooser& chooser, double& now_s, const std::vector<double>& ages_s) {
  std::vector<StatePolicy> policies;
  for (const double age_s : ages_s) {
    if (const auto choice = chooser.note(age_s, now_s += 0.01)) policies.push_back(choice->policy);
  }
  return policies;
}

std::vector<double> times(int count, double age_s) {
  return std::vector<double>(static_cast<std::size_t>(count), age_s);
}

TEST(PolicyChooser, AnOldFirstStateOfADriverDoesNotDecideForEver) {
  PolicyChooser chooser(StatePolicy::kAuto, false);
  double now_s = 5.0;
  EXPECT_EQ(chosen(chooser, now_s, {3600.0}), std::vector<StatePolicy>{StatePolicy::kEveryState});
  EXPECT_TRUE(chosen(chooser, now_s, times(90, 0.001)).empty());
  EXPECT_EQ(chosen(chooser, now_s, times(1000, 0.001)), std::vector<StatePolicy>{StatePolicy::kNewestState});
}

TEST(PolicyChooser, ABacklogAndSingleStatesAreNoEvidence) {
  PolicyChooser chooser(StatePolicy::kAuto, false);
  double now_s = 5.0;
  EXPECT_EQ(chosen(chooser, now_s, {0.001}), std::vector<StatePolicy>{StatePolicy::kNewestState});
  for (int i = 0; i < 5000; ++i) EXPECT_FALSE(chooser.note(10.0 - 0.0018 * i, now_s += 1e-5));  // stopped for 10 s
  for (int i = 0; i < 1000; ++i) EXPECT_FALSE(chooser.note(i % 2 == 0 ? 3600.0 : 0.001, now_s += 0.01));
  EXPECT_EQ(chosen(chooser, now_s, times(1000, 3600.0)), std::vector<StatePolicy>{StatePolicy::kEveryState});
}

TEST(PolicyChooser, AnotherSourceDecidesAtOnceWhenTimeStartsAgain) {
  PolicyChooser chooser(StatePolicy::kAuto, false);
  double now_s = 5.0;
  chosen(chooser, now_s, times(10, 0.001));
  chooser.startAgain();
  EXPECT_EQ(chosen(chooser, now_s, times(500, 3600.0)), std::vector<StatePolicy>{StatePolicy::kEveryState});
  chooser.startAgain();
  EXPECT_TRUE(chosen(chooser, now_s, times(500, 3600.0)).empty());  // the same once more: nothing to tell
}

TEST(PolicyChooser, NothingMovesTheSceneOrSimulatedTime) {
  for (const bool simulated_time : {false, true}) {
    PolicyChooser chooser(simulated_time ? StatePolicy::kAuto : StatePolicy::kEveryState, simulated_time);
    double now_s = 5.0;
    EXPECT_EQ(chosen(chooser, now_s, times(500, 0.001)), std::vector<StatePolicy>{StatePolicy::kEveryState});
    EXPECT_TRUE(chosen(chooser, now_s, times(500, 3600.0)).empty());
  }
}

TEST(JointStatePolicy, SaysWhy) {
  EXPECT_NE(choosePolicy(StatePolicy::kAuto, true, 0.0).reason.find("/use_sim_time"), std::string::npos);
  EXPECT_NE(choosePolicy(StatePolicy::kAuto, false, 0.25).reason.find("0.25 s ago"), std::string::npos);
  EXPECT_NE(choosePolicy(StatePolicy::kAuto, false, -60.0).reason.find("60 s ahead"), std::string::npos);
}

TEST(Lag, IsJudgedByTheBoundOfThePolicy) {
  LiveFigures figures;
  figures.newest_state = true;
  EXPECT_EQ(lagBound(figures, 0.02), 0.02);
  figures.newest_state = false;
  EXPECT_EQ(lagBound(figures, 0.02), 1.0);
  EXPECT_EQ(lagBound(figures, 3.0), 3.0);
  EXPECT_EQ(judgeLag(0.02, 0.02), LagVerdict::kWithinBound);
  EXPECT_EQ(judgeLag(0.021, 0.02), LagVerdict::kOverBound);
  EXPECT_EQ(judgeLag(0.101, 0.02), LagVerdict::kFarOverBound);
}

TEST(LongestStep, LeavesADriversStampsRoomToJitter) {
  EXPECT_EQ(longestStep(false, 0.001), 0.001);
  EXPECT_GT(longestStep(true, 0.001), 0.0011);
  EXPECT_LT(longestStep(true, 0.001), 0.0015);  // an interval of two steps stays two steps
}

TEST(RealTimeFactor, IsThatOfTheLastSecond) {
  RealTimeFactor factor;
  EXPECT_EQ(factor.value(1.0), 0.0);
  double now_s = 50.0;
  for (int i = 0; i < 3000; ++i) factor.note(now_s += 0.001, 0.001);
  EXPECT_NEAR(factor.value(now_s), 1.0, 1e-9);
  for (int i = 0; i < 400; ++i) factor.note(now_s += 0.004, 0.001);  // 1.6 s at a quarter
  EXPECT_NEAR(factor.value(now_s), 0.25, 1e-9);
  EXPECT_NEAR(factor.value(now_s + 9.0), 0.025, 0.005);  // nothing comes any more
}

TEST(KeepUpAdvice, HasTheFiguresAndWhatToChange) {
  LiveFigures figures;
  figures.newest_state = true;
  figures.step_cost_s = 0.004;
  figures.steps = 500;
  figures.simulated_s = 2.0;  // lengthened: 250 per second, 1000 are wanted
  const std::string live = keepUpAdvice(figures, 0.001, 0.02, 3087);
  expectContains(live, {"4 ms", "1000 steps", "4 s of work per second", "0.02 s", "3087 nodes", "step.max_step_s",
                        "solver.time_budget_s"});
  EXPECT_EQ(live.find("something else"), std::string::npos);
  figures.newest_state = false;
  figures.steps = 4000;
  figures.step_cost_s = 0.0001;
  figures.lag_s = 3.5;
  figures.waiting = 42;
  expectContains(keepUpAdvice(figures, 0.001, 0.02, 3087),
                 {"0.2 s of work per second", "something else", "3.5 s", "42 joint states wait", "newest_state"});
}

/// It was told once, of a step of 0.3 ms before the first contact ("That fits"), and not again at 30 ms.
TEST(KeepUpNews, IsToldAgainWhenStepsCostOrNodesAreSeveralTimesAsMuchButNotForEver) {
  KeepUpNews news;
  EXPECT_TRUE(news.take(0.0003, 1000));
  EXPECT_FALSE(news.take(0.0003, 1000));
  EXPECT_FALSE(news.take(0.0008, 1000)) << "the machine is busy";
  EXPECT_TRUE(news.take(0.03, 1000));
  EXPECT_FALSE(news.take(0.0003, 1000)) << "it was worse";
  EXPECT_FALSE(news.take(0.03, 2000));
  EXPECT_TRUE(news.take(0.03, 5000)) << "refined";
  int told = 0;
  for (double cost_s = 0.05; cost_s < 1e9; cost_s *= 10.0) told += static_cast<int>(news.take(cost_s, 5000));
  EXPECT_EQ(told, 2);
}

TEST(CountsLine, NamesEveryCount) {
  LiveFigures figures;
  figures.received = 100;
  figures.merged = 20;
  figures.dropped = 5;
  figures.by_verdict[static_cast<std::size_t>(Verdict::kAccepted)] = 60;
  figures.by_verdict[static_cast<std::size_t>(Verdict::kLate)] = 4;
  figures.by_verdict[static_cast<std::size_t>(Verdict::kNotFinite)] = 3;
  figures.waiting = 8;
  figures.wrenches = 59;
  figures.largest_lag_s = 0.0123;
  EXPECT_EQ(
      countsLine(figures),
      "joint states: 100 received, 60 accepted, 20 merged, 5 dropped, 7 refused (3 position not finite, 4 too late), "
      "8 waiting; 59 wrenches published, 0 resets, largest lag 0.0123 s");
}

}  // namespace live_figures_test
}  // namespace tissue_contact
