/// @file
/// JointStatePlayer and stamps that do not simply go on: late ones, loops, restarts, stamps far in the future.
#include <utility>

#include "joint_state_player_fixture.h"

namespace tissue_contact {
namespace {

std::unique_ptr<Simulator> oneProbe() { return makeSimulator(probe("a", "/a", 0.0)); }
std::unique_ptr<Simulator> twoProbes() { return makeSimulator(probe("a", "/a", -0.015) + probe("b", "/b", 0.015)); }

Trace run(const std::vector<JointStateSample>& samples, std::int64_t late) {
  const auto simulator = oneProbe();
  JointStatePlayer player(*simulator);
  Trace trace;
  for (const JointStateSample& s : samples) {
    player.push(0, s);
    for (const PlayedSample& played : drain(player)) {
      if (played.verdict == Verdict::kAccepted) trace.add(played, *simulator);
    }
  }
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
  const Trace got = run(jittered, 1);
  EXPECT_TRUE(got.pressed());
  EXPECT_TRUE(got == run(without, 0));
}

TEST(JointStateTime, UpToMaxGapBackIsLateAndFartherBackALoop) {
  const auto simulator = oneProbe();
  JointStatePlayer player(*simulator);
  const std::int64_t last = 2 * kSecond;
  EXPECT_EQ(verdictAt(player, 0, last), Verdict::kAccepted);
  EXPECT_EQ(verdictAt(player, 0, last - 50 * kMillisecond), Verdict::kLate);
  EXPECT_EQ(verdictAt(player, 0, last - 10 * kMillisecond), Verdict::kLate);  // the last one stays where it was
  EXPECT_EQ(verdictAt(player, 0, last), Verdict::kDuplicateStamp);
  EXPECT_EQ(player.resets(), 0);
  EXPECT_EQ(verdictAt(player, 0, last - 50 * kMillisecond - 1), Verdict::kAccepted);
  EXPECT_EQ(player.resets(), 1);
}

TEST(JointStateTime, ALateSampleSaysWhereTheTopicIs) {
  const auto simulator = oneProbe();
  JointStatePlayer player(*simulator);
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

TEST(JointStateTime, ARestartIsForgottenOnceStampsHaveGoneOnByMaxGap) {
  const auto simulator = oneProbe();
  JointStatePlayer player(*simulator);
  verdictAt(player, 0, kSecond);
  player.restart();
  for (const int ms : {20, 40, 51}) EXPECT_EQ(verdictAt(player, 0, kSecond + ms * kMillisecond), Verdict::kAccepted);
  EXPECT_EQ(verdictAt(player, 0, kSecond + 50 * kMillisecond), Verdict::kLate);
  EXPECT_EQ(player.resets(), 0);
}

TEST(JointStateTime, ARestartBeforeAnythingWasHeardMeansNothing) {
  const auto simulator = oneProbe();
  JointStatePlayer player(*simulator);
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

TEST(JointStateTime, AShortLoopWithoutARestartIsNotRefusedForEver) {
  const auto simulator = oneProbe();
  JointStatePlayer player(*simulator);
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
TEST(JointStateTime, ATopicJoinsTheLoopThatAnotherHasBegun) {
  const auto simulator = twoProbes();
  JointStatePlayer player(*simulator);
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

TEST(JointStateTime, AStampFarInTheFutureIsBelievedAndWhatFollowsIsALoop) {
  const auto simulator = oneProbe();
  JointStatePlayer player(*simulator);
  EXPECT_EQ(verdictAt(player, 0, kSecond), Verdict::kAccepted);
  EXPECT_EQ(verdictAt(player, 0, 3600 * kSecond), Verdict::kAccepted);
  EXPECT_EQ(player.gaps(), 1);
  EXPECT_EQ(verdictAt(player, 0, kSecond + 10 * kMillisecond), Verdict::kAccepted);
  EXPECT_EQ(verdictAt(player, 0, kSecond + 20 * kMillisecond), Verdict::kAccepted);
  EXPECT_EQ(player.resets(), 1);
}

}  // namespace
}  // namespace tissue_contact
