/// @file
/// JointStatePlayer and stamps that do not simply go on: late ones, loops, restarts, stamps far in the future.
#include <algorithm>
#include <utility>

#include "joint_state_player_fixture.h"

namespace tissue_contact {
namespace joint_state_time_test {

Trace traceOf(const std::vector<JointStateSample>& samples, std::int64_t late) {
  const auto simulator = oneProbe();
  JointStatePlayer player(*simulator);
  Order order;
  for (const JointStateSample& s : samples) order.emplace_back(0, s);
  Trace trace = run(*simulator, player, order);
  EXPECT_EQ(player.count(Verdict::kLate), late);
  EXPECT_EQ(player.resets(), 0);
  return trace;
}

Verdict verdictAt(JointStatePlayer& player, int topic, std::int64_t stamp_ns) {
  player.push(topic, sample(stamp_ns, 0.0));
  const std::vector<PlayedSample> all = drain(player);
  EXPECT_EQ(all.size(), 1U) << stamp_ns;
  return all.empty() ? Verdict::kBadStamp : all.front().verdict;
}

TEST(JointStateTime, AStampALittleBackIsLateAndChangesNoBit) {
  std::vector<JointStateSample> jittered = press(kSecond, 0.006);
  jittered[20].stamp_ns = jittered[19].stamp_ns - 280;
  std::vector<JointStateSample> without = press(kSecond, 0.006);
  without.erase(without.begin() + 20);
  const Trace got = traceOf(jittered, 1);
  EXPECT_TRUE(got.pressed());
  EXPECT_TRUE(got == traceOf(without, 0));
}

/// Half a millimetre within 280 ns would be a tool at 1800 m/s.
TEST(JointStateTime, AStampALittleAheadIsPartOfTheNextInterval) {
  std::vector<JointStateSample> jittered = press(kSecond, 0.006);
  jittered[20].stamp_ns = jittered[19].stamp_ns + 280;
  std::vector<JointStateSample> without = press(kSecond, 0.006);
  without.erase(without.begin() + 20);
  const Trace got = traceOf(jittered, 0);
  Trace expected = traceOf(without, 0);
  // One row more, with the wrench of the step before; all others to the bit.
  ASSERT_EQ(got.stamps.size(), expected.stamps.size() + 1);
  expected.stamps.insert(expected.stamps.begin() + 20, jittered[20].stamp_ns);
  const std::vector<double> before(expected.forces.begin() + 19 * 6, expected.forces.begin() + 20 * 6);
  expected.forces.insert(expected.forces.begin() + 20 * 6, before.begin(), before.end());
  EXPECT_TRUE(got.pressed());
  EXPECT_TRUE(got == expected);
}

/// States faster than the shortest step are steps as soon as their intervals add up to one.
TEST(JointStateTime, IntervalsTooShortAddUp) {
  const auto simulator = oneProbe();
  const auto shortest_ns =
      static_cast<std::int64_t>(1e9 * std::min(JointStatePlayer::kShortest_s,
                                               JointStatePlayer::kShortestShare * simulator->scene().step.max_step_s));
  JointStatePlayer player(*simulator);
  constexpr int kStates = 101;
  for (int k = 0; k < kStates; ++k) {
    player.push(0, sample(kSecond + k * shortest_ns / 10, 0.0));
    drain(player);
  }
  EXPECT_EQ(player.count(Verdict::kAccepted), kStates);
  EXPECT_EQ(simulator->stepCount(), (kStates - 1) / 10);
}

/// One outlier on one of two topics; the other's next stamp lies before the last one before the outlier.
TEST(JointStateTime, AnotherTopicMayBeBehindWhereTimeIsResumed) {
  for (const StatePolicy policy : {StatePolicy::kEveryState, StatePolicy::kNewestState}) {
    const auto simulator = twoProbes();
    JointStatePlayer player(*simulator);
    player.setPolicy(policy);
    const std::int64_t start = 100 * kSecond;
    int pushed = 0;
    int resumed = 0;
    std::int64_t last = 0;
    const auto play = [&](int topic, std::int64_t stamp_ns) {
      player.push(topic, sample(stamp_ns, 0.0));
      ++pushed;
      for (const PlayedSample& played : drain(player)) {
        resumed += static_cast<int>(played.was_resumed);
        if (played.verdict == Verdict::kAccepted) last = played.stamp_ns;
      }
    };
    play(1, start);
    play(0, start + 45 * kMillisecond);
    play(0, 50 * start);
    play(0, start + 46 * kMillisecond);
    for (int k = 1; k < 20; ++k) {
      play(1, start + 10 * k * kMillisecond);
      if (k > 5) play(0, start + (10 * k + 1) * kMillisecond);
    }
    player.finish();
    drain(player);
    EXPECT_EQ(player.resets(), 0);
    EXPECT_LE(resumed, 1);
    EXPECT_GT(last, start + 150 * kMillisecond);
    EXPECT_EQ(countedBy(player), pushed);
  }
}

/// What waits for another topic is no larger than the instrument's joints.
TEST_F(OneProbe, NamesThatNobodyKnowsAreNotKept) {
  JointStateSample large = sample(kSecond, -0.001);
  for (int k = 0; k < 1000; ++k) {
    large.names.push_back("unknown" + std::to_string(k));
    large.positions.push_back(1.0);
    large.names.emplace_back("x");
    large.positions.push_back(1e-6 * k);
  }
  player.push(0, std::move(large));
  ASSERT_EQ(drain(player).size(), 1U);
  EXPECT_EQ(simulator->jointPositions(0), VectorX(Vector3(1e-6 * 999, 0.0, -0.001)));  // of one name the last counts
}

TEST_F(OneProbe, UpToMaxGapBackIsLateAndFartherBackALoop) {
  const std::int64_t last = 2 * kSecond;
  EXPECT_EQ(verdictAt(player, 0, last), Verdict::kAccepted);
  EXPECT_EQ(verdictAt(player, 0, last - 50 * kMillisecond), Verdict::kLate);
  EXPECT_EQ(verdictAt(player, 0, last - 10 * kMillisecond), Verdict::kLate);  // the last one stays where it was
  EXPECT_EQ(verdictAt(player, 0, last), Verdict::kDuplicateStamp);
  EXPECT_EQ(player.resets(), 0);
  player.push(0, sample(last - 50 * kMillisecond - 1, 0.0));
  player.push(0, sample(last - 50 * kMillisecond + 1, 0.0));
  EXPECT_TRUE(drain(player).empty());  // a stray or a loop: the next will show
  EXPECT_EQ(player.waiting(), 2);
  player.push(0, sample(last - 40 * kMillisecond, 0.0));
  const std::vector<PlayedSample> loop = drain(player);
  ASSERT_EQ(loop.size(), 3U);
  EXPECT_TRUE(loop[0].was_reset);
  EXPECT_EQ(loop[0].stamp_ns, last - 50 * kMillisecond - 1);
  EXPECT_EQ(player.resets(), 1);
}

TEST_F(OneProbe, ALateSampleSaysWhereTheTopicIs) {
  verdictAt(player, 0, kSecond);
  player.push(0, sample(kSecond - 280, 0.0));
  const std::vector<PlayedSample> all = drain(player);
  ASSERT_EQ(all.size(), 1U);
  EXPECT_NE(all[0].detail.find("/a at 0.999999720 s"), std::string::npos) << all[0].detail;
  EXPECT_NE(all[0].detail.find("last joint state is at 1.000000000 s"), std::string::npos) << all[0].detail;
  EXPECT_TRUE(all[0].instruments.empty());
}

TEST(JointStateTime, AfterARestartAnyStepBackIsALoop) {
  for (const std::int64_t back : {std::int64_t{0}, std::int64_t{1}, 20 * kMillisecond, 400 * kMillisecond}) {
    const auto simulator = oneProbe();
    JointStatePlayer player(*simulator);
    verdictAt(player, 0, kSecond);
    player.restart();
    EXPECT_EQ(verdictAt(player, 0, kSecond - back), Verdict::kAccepted) << back;
    EXPECT_EQ(player.resets(), 1) << back;
    EXPECT_EQ(verdictAt(player, 0, kSecond - back - 280), Verdict::kLate) << back;
    EXPECT_EQ(player.resets(), 1) << back;  // the restart is over
  }
}

TEST_F(OneProbe, ARestartIsForgottenOnceStampsHaveGoneOnByMaxGap) {
  verdictAt(player, 0, kSecond);
  player.restart();
  for (const int ms : {20, 40, 51}) EXPECT_EQ(verdictAt(player, 0, kSecond + ms * kMillisecond), Verdict::kAccepted);
  EXPECT_EQ(verdictAt(player, 0, kSecond + 50 * kMillisecond), Verdict::kLate);
  EXPECT_EQ(player.resets(), 0);
}

TEST_F(OneProbe, ARestartBeforeAnythingWasHeardMeansNothing) {
  player.restart();
  EXPECT_EQ(verdictAt(player, 0, kSecond), Verdict::kAccepted);
  EXPECT_EQ(verdictAt(player, 0, kSecond - 280), Verdict::kLate);
}

/// Passes of a recording of 40 ms, shorter than max_gap_s, on two topics.
TEST(JointStateTime, AShortLoopOnTwoTopicsResetsOncePerRestart) {
  for (const bool leftover : {false, true}) {
    SCOPED_TRACE(leftover);
    const auto simulator = twoProbes();
    JointStatePlayer player(*simulator);
    for (int pass = 0; pass < 3; ++pass) {
      if (pass > 0) player.restart();
      // A message of the pass before may still be on its way.
      if (pass > 0 && leftover) player.push(1, sample(kSecond + (44 + pass) * kMillisecond, 0.0));
      for (int i = 0; i < 5; ++i) {
        player.push(0, sample(kSecond + i * 10 * kMillisecond, 0.0));
        player.push(1, sample(kSecond + (i * 10 + 3) * kMillisecond, 0.0));
        drain(player);
      }
    }
    player.finish();
    drain(player);
    EXPECT_EQ(player.resets(), 2);
    EXPECT_EQ(player.count(Verdict::kAccepted), leftover ? 32 : 30);
    EXPECT_EQ(player.count(Verdict::kLate), 0);
  }
}

TEST_F(OneProbe, AShortLoopWithoutARestartIsNotRefusedForEver) {
  std::vector<std::int64_t> accepted_by_pass;
  for (int pass = 0; pass < 5; ++pass) {
    const std::int64_t before = player.count(Verdict::kAccepted);
    for (int i = 0; i < 4; ++i) {
      player.push(0, sample(kSecond + i * 10 * kMillisecond, 0.0));
      for (const PlayedSample& played : drain(player)) {
        EXPECT_EQ(played.detail.find("--clock") != std::string::npos,
                  played.verdict == Verdict::kLate && (pass > 1 || i > 0))
            << played.detail;
      }
    }
    accepted_by_pass.push_back(player.count(Verdict::kAccepted) - before);
  }
  // The late ones of a pass go on by 20 ms: after the third pass by more than max_gap_s, 50 ms.
  EXPECT_EQ(accepted_by_pass, (std::vector<std::int64_t>{4, 0, 0, 0, 4}));
  EXPECT_EQ(player.resets(), 1);
}

/// The second topic begins later in the recording, so that it goes back by less than max_gap_s.
TEST_F(TwoProbes, ATopicJoinsTheLoopThatAnotherHasBegun) {
  for (int pass = 0; pass < 2; ++pass) {
    for (int i = 0; i < 7; ++i) {
      player.push(0, sample(kSecond + i * 10 * kMillisecond, 0.0));
      if (i > 3) player.push(1, sample(kSecond + i * 10 * kMillisecond, 0.0));
      drain(player);
    }
  }
  player.finish();
  drain(player);
  EXPECT_EQ(player.resets(), 1);
  EXPECT_EQ(player.count(Verdict::kLate), 0);
  EXPECT_EQ(player.count(Verdict::kAccepted), 20);
}

}  // namespace joint_state_time_test
}  // namespace tissue_contact
