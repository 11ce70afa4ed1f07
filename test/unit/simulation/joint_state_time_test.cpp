/// @file
/// JointStatePlayer and stamps that do not simply go on: late ones, loops, restarts, stamps far in the future.
#include <algorithm>
#include <random>
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

/// Half a millimetre within 280 ns would be a tool at 1800 m/s.
TEST(JointStateTime, AStampALittleAheadIsPartOfTheNextInterval) {
  std::vector<JointStateSample> jittered = press(kSecond, 0.006);
  jittered[20].stamp_ns = jittered[19].stamp_ns + 280;
  std::vector<JointStateSample> without = press(kSecond, 0.006);
  without.erase(without.begin() + 20);
  const Trace got = run(jittered, 0);
  Trace expected = run(without, 0);
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
    std::int64_t counted = player.merged() + player.waiting();
    for (int v = 0; v < kVerdictCount; ++v) counted += player.count(static_cast<Verdict>(v));
    EXPECT_EQ(counted, pushed);
  }
}

/// What waits for another topic is no larger than the instrument's joints.
TEST(JointStateTime, NamesThatNobodyKnowsAreNotKept) {
  const auto simulator = oneProbe();
  JointStatePlayer player(*simulator);
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

TEST(JointStateTime, UpToMaxGapBackIsLateAndFartherBackALoop) {
  const auto simulator = oneProbe();
  JointStatePlayer player(*simulator);
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

/// Plays all, and says how many joint states in a row went without a moment at most.
struct Outcome {
  int accepted = 0;
  int refused = 0;
  int gaps = 0;
  int resets = 0;
  int resumed = 0;
  int longest_silence = 0;
};

Outcome play(JointStatePlayer& player, const std::vector<std::int64_t>& stamps) {
  Outcome outcome;
  int silence = 0;
  for (const std::int64_t stamp_ns : stamps) {
    player.push(0, sample(stamp_ns, 0.0));
    outcome.longest_silence = std::max(outcome.longest_silence, ++silence);
    for (const PlayedSample& played : drain(player)) {
      if (played.verdict != Verdict::kAccepted) {
        ++outcome.refused;
        EXPECT_EQ(played.verdict, Verdict::kTwoClocks) << played.detail;
        EXPECT_NE(played.detail.find("NTP"), std::string::npos) << played.detail;
        continue;
      }
      silence = 0;
      ++outcome.accepted;
      outcome.resumed += static_cast<int>(played.was_resumed);
    }
  }
  outcome.gaps = static_cast<int>(player.gaps());
  outcome.resets = static_cast<int>(player.resets());
  return outcome;
}

constexpr std::int64_t kHour = 3600 * kSecond;

TEST(JointStateTime, OfTwoClocksOnATopicTheFirstIsFollowed) {
  for (const std::int64_t other : {-kHour, kHour, 2 * kSecond, -2 * kSecond}) {
    SCOPED_TRACE(other);
    const auto simulator = oneProbe();
    JointStatePlayer player(*simulator);
    std::vector<std::int64_t> stamps;
    for (int i = 0; i < 750; ++i) {
      stamps.push_back(2 * kHour + i * 4 * kMillisecond);
      stamps.push_back(2 * kHour + (i * 4 + 2) * kMillisecond + other);
    }
    const Outcome outcome = play(player, stamps);
    // One ahead is believed at first, as after a pause, and simulated as max_gap_s; then it is known better.
    EXPECT_EQ(outcome.accepted, other > 0 ? 751 : 750);
    EXPECT_EQ(outcome.gaps, other > 0 ? 1 : 0);
    EXPECT_EQ(outcome.resumed, other > 0 ? 1 : 0);
    EXPECT_EQ(outcome.resets, 0);
    EXPECT_EQ(outcome.accepted + outcome.refused + player.waiting(), 1500);
    EXPECT_LE(simulator->stepCount(), 750 * 4 + (other > 0 ? 50 : 0));
  }
}

/// A second publisher of ten times the rate has ten stamps in a row, which look like a loop; the first going on tells.
TEST(JointStateTime, AFasterSecondClockResetsOnceAtMost) {
  for (const std::int64_t other : {-kHour, kHour}) {
    SCOPED_TRACE(other);
    const auto simulator = oneProbe();
    JointStatePlayer player(*simulator);
    std::vector<std::int64_t> stamps;
    for (int i = 0; i < 100; ++i) {
      stamps.push_back(2 * kHour + i * 10 * kMillisecond);
      for (int k = 1; k <= 10; ++k) stamps.push_back(2 * kHour + other + (i * 10 + k) * kMillisecond);
    }
    const Outcome outcome = play(player, stamps);
    EXPECT_EQ(outcome.resets, other > 0 ? 0 : 1);
    EXPECT_EQ(outcome.resumed, 1);
    EXPECT_EQ(outcome.accepted, 110);
  }
}

TEST(JointStateTime, WhereTheFirstClockEndsTheSecondIsFollowed) {
  for (const std::int64_t other : {-kHour, kHour}) {
    SCOPED_TRACE(other);
    const auto simulator = oneProbe();
    JointStatePlayer player(*simulator);
    std::vector<std::int64_t> stamps;
    for (int i = 0; i < 60; ++i) {
      if (i < 30) stamps.push_back(2 * kHour + i * 4 * kMillisecond);
      stamps.push_back(2 * kHour + (i * 4 + 2) * kMillisecond + other);
    }
    const Outcome outcome = play(player, stamps);
    EXPECT_GE(outcome.accepted, 30 + 30 - 15);  // those within max_gap_s, 50 ms, had to show it
    EXPECT_EQ(outcome.resets, other > 0 ? 0 : 1);
    EXPECT_LE(outcome.longest_silence, 15);
  }
}

TEST(JointStateTime, ASingleStampFarOffChangesNothingThatFollows) {
  for (const std::int64_t off : {-kHour, -kSecond, kSecond, kHour}) {
    SCOPED_TRACE(off);
    const auto simulator = oneProbe();
    JointStatePlayer player(*simulator);
    std::vector<std::int64_t> stamps;
    for (int i = 0; i < 100; ++i) stamps.push_back(2 * kHour + i * 10 * kMillisecond + (i == 50 ? off : 0));
    const Outcome outcome = play(player, stamps);
    EXPECT_EQ(outcome.resets, 0);
    EXPECT_EQ(outcome.gaps, off > 0 ? 1 : 0);
    EXPECT_EQ(outcome.accepted, off > 0 ? 100 : 99);
    EXPECT_EQ(outcome.longest_silence, off > 0 ? 1 : 2);
    // Half a second (ten gaps) of a clean clock later a loop is a loop again at its third stamp.
    for (int i = 100; i < 200; ++i) stamps.push_back(2 * kHour + i * 10 * kMillisecond);
    play(player, {stamps.begin() + 100, stamps.end()});
    EXPECT_EQ(play(player, {kSecond, kSecond + kMillisecond, kSecond + 2 * kMillisecond}).accepted, 3);
    EXPECT_EQ(player.resets(), 1);
  }
}

/// Each tenth stamp anywhere within an hour: one of them is believed, so no more than one gap is simulated.
TEST(JointStateTime, StampsFarOffAtRandomDoNotTakeUpTheTime) {
  const auto simulator = oneProbe();
  JointStatePlayer player(*simulator);
  std::mt19937 random(3);
  std::vector<std::int64_t> stamps;
  for (int i = 0; i < 1000; ++i) {
    const std::int64_t off = i % 10 == 9 ? static_cast<std::int64_t>(random() % 7200) * kSecond - kHour : 0;
    stamps.push_back(2 * kHour + i * 2 * kMillisecond + off);
  }
  const Outcome outcome = play(player, stamps);
  EXPECT_GE(outcome.accepted, 900);
  EXPECT_LE(outcome.gaps, 1);
  EXPECT_EQ(outcome.resets, 0);
  EXPECT_LE(outcome.longest_silence, 2);
}

TEST(JointStateTime, TissueStaysDeformedThroughAStampFarAhead) {
  const auto simulator = oneProbe();
  JointStatePlayer player(*simulator);
  std::vector<JointStateSample> samples = press(kSecond, 0.006);
  samples[20].stamp_ns += kHour;
  double before = 0.0;
  for (std::size_t i = 0; i < samples.size(); ++i) {
    player.push(0, samples[i]);
    for (const PlayedSample& played : drain(player)) EXPECT_EQ(played.was_resumed, i == 21);
    const double force = simulator->wrench(0).force.z();
    if (i > 20) {  // a reset would start from none; a gap lets the tissue come to rest
      EXPECT_GT(force, 0.7 * before) << i;
    }
    before = force;
  }
  EXPECT_GT(before, 0.01);
  EXPECT_EQ(player.gaps(), 1);
  EXPECT_EQ(player.resets(), 0);
}

TEST(JointStateTime, AFirstStampFarOffIsLeftBehind) {
  for (const std::int64_t off : {-kHour, kHour}) {
    const auto simulator = oneProbe();
    JointStatePlayer player(*simulator);
    std::vector<std::int64_t> stamps = {2 * kHour + off};  // latched, of another day
    for (int i = 1; i < 50; ++i) stamps.push_back(2 * kHour + i * 10 * kMillisecond);
    EXPECT_EQ(play(player, stamps).accepted, 50);
    EXPECT_EQ(player.waiting(), 0);
  }
}

TEST(JointStateTime, PausesAndSlowTopicsAreBelievedAtOnce) {
  const auto simulator = oneProbe();
  JointStatePlayer player(*simulator);
  std::vector<std::int64_t> stamps;
  for (int i = 1; i <= 20; ++i) stamps.push_back(i * kSecond);  // twenty times max_gap_s apart
  const Outcome outcome = play(player, stamps);
  EXPECT_EQ(outcome.accepted, 20);
  EXPECT_EQ(outcome.longest_silence, 1);
  EXPECT_EQ(play(player, stamps).accepted, 20);  // and loop
  EXPECT_EQ(player.resets(), 1);
}

TEST(JointStateTime, WhatNoOtherHasConfirmedIsRefusedAtTheEnd) {
  const auto simulator = oneProbe();
  JointStatePlayer player(*simulator);
  play(player, {kHour, kHour + kMillisecond, kSecond, kSecond + kMillisecond});
  EXPECT_EQ(player.waiting(), 2);
  player.finish();
  drain(player);
  EXPECT_EQ(player.waiting(), 0);
  EXPECT_EQ(player.count(Verdict::kTwoClocks), 2);
  EXPECT_EQ(player.resets(), 0);
}

TEST(JointStateTime, ARestartConfirmsWhatIsHeld) {
  const auto simulator = twoProbes();
  JointStatePlayer player(*simulator);
  for (const std::int64_t stamp : {kHour, kSecond}) {
    for (const int topic : {0, 1}) player.push(topic, sample(stamp, 0.0));
  }
  EXPECT_EQ(drain(player).size(), 1U);
  player.restart();
  const std::vector<PlayedSample> played = drain(player);
  ASSERT_EQ(played.size(), 1U);
  EXPECT_TRUE(played[0].was_reset);
  EXPECT_EQ(played[0].accepted, 2);
  for (const int topic : {0, 1}) player.push(topic, sample(kSecond - kMillisecond, 0.0));
  drain(player);
  EXPECT_EQ(player.resets(), 1);
  EXPECT_EQ(player.count(Verdict::kLate), 2);
}

/// Bursts and turns of any length between clocks: nothing is lost uncounted, and time simulated stays in proportion.
TEST(JointStateTime, AnyMixtureOfClocksIsCountedAndBounded) {
  for (unsigned seed = 1; seed <= 8; ++seed) {
    SCOPED_TRACE(seed);
    const auto simulator = oneProbe();
    JointStatePlayer player(*simulator);
    std::mt19937 random(seed);
    std::vector<std::int64_t> offsets = {0, kHour, -kHour, 300 * kMillisecond};
    std::int64_t pushed = 0;
    std::int64_t now = 2 * kHour;
    while (pushed < 2000) {
      const std::int64_t offset = offsets[random() % offsets.size()];
      for (auto k = 1 + random() % 12; k > 0; --k) {
        player.push(0, sample((now += 2 * kMillisecond) + offset, 0.0));
        ++pushed;
        drain(player);
      }
    }
    std::int64_t sum = player.waiting();
    for (int v = 0; v < kVerdictCount; ++v) sum += player.count(static_cast<Verdict>(v));
    EXPECT_EQ(sum, pushed);
    EXPECT_GT(player.count(Verdict::kAccepted), 100);
    // In 4 s: what is not trusted changes clocks after 50 ms at the earliest, and that costs a gap or a reset.
    EXPECT_LE(player.gaps() + player.resets(), 4000 / 50 + 1);
  }
}

}  // namespace
}  // namespace tissue_contact
