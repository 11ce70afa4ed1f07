/// @file
/// JointStatePlayer and stamps of two clocks on one topic, or far off: whom it follows, and that all are counted.
#include <algorithm>
#include <random>

#include "joint_state_player_fixture.h"

namespace tissue_contact {
namespace joint_state_clocks_test {

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

TEST(JointStateClocks, OfTwoClocksOnATopicTheFirstIsFollowed) {
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
TEST(JointStateClocks, AFasterSecondClockResetsOnceAtMost) {
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

TEST(JointStateClocks, WhereTheFirstClockEndsTheSecondIsFollowed) {
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

TEST(JointStateClocks, ASingleStampFarOffChangesNothingThatFollows) {
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
TEST_F(OneProbe, StampsFarOffAtRandomDoNotTakeUpTheTime) {
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

TEST_F(OneProbe, TissueStaysDeformedThroughAStampFarAhead) {
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

TEST(JointStateClocks, AFirstStampFarOffIsLeftBehind) {
  for (const std::int64_t off : {-kHour, kHour}) {
    const auto simulator = oneProbe();
    JointStatePlayer player(*simulator);
    std::vector<std::int64_t> stamps = {2 * kHour + off};  // latched, of another day
    for (int i = 1; i < 50; ++i) stamps.push_back(2 * kHour + i * 10 * kMillisecond);
    EXPECT_EQ(play(player, stamps).accepted, 50);
    EXPECT_EQ(player.waiting(), 0);
  }
}

TEST_F(OneProbe, PausesAndSlowTopicsAreBelievedAtOnce) {
  std::vector<std::int64_t> stamps;
  for (int i = 1; i <= 20; ++i) stamps.push_back(i * kSecond);  // twenty times max_gap_s apart
  const Outcome outcome = play(player, stamps);
  EXPECT_EQ(outcome.accepted, 20);
  EXPECT_EQ(outcome.longest_silence, 1);
  EXPECT_EQ(play(player, stamps).accepted, 20);  // and loop
  EXPECT_EQ(player.resets(), 1);
}

TEST_F(OneProbe, WhatNoOtherHasConfirmedIsRefusedAtTheEnd) {
  play(player, {kHour, kHour + kMillisecond, kSecond, kSecond + kMillisecond});
  EXPECT_EQ(player.waiting(), 2);
  player.finish();
  drain(player);
  EXPECT_EQ(player.waiting(), 0);
  EXPECT_EQ(player.count(Verdict::kTwoClocks), 2);
  EXPECT_EQ(player.resets(), 0);
}

TEST_F(TwoProbes, ARestartConfirmsWhatIsHeld) {
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
TEST(JointStateClocks, AnyMixtureOfClocksIsCountedAndBounded) {
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
    EXPECT_EQ(countedBy(player), pushed);
    EXPECT_GT(player.count(Verdict::kAccepted), 100);
    // In 4 s: what is not trusted changes clocks after 50 ms at the earliest, and that costs a gap or a reset.
    EXPECT_LE(player.gaps() + player.resets(), 4000 / 50 + 1);
  }
}

}  // namespace joint_state_clocks_test
}  // namespace tissue_contact
