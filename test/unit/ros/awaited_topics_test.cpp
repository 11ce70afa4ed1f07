/// @file
/// A topic whose stamps fall behind in a recording played fast: waited for by the wall clock, too.
#include "ros/node/awaited_topics.h"

#include <gtest/gtest.h>

#include "unit/simulation/joint_state_player_fixture.h"

namespace tissue_contact {
namespace awaited_topics_test {

constexpr double kMost_s = 0.05;  // wall time; max_gap_s of the fixture's scene is .05 s of message time

class Awaited : public TwoProbes {
 protected:
  void receive(int topic, std::int64_t stamp_ns, double received_s) {
    player.push(topic, sample(stamp_ns, 0.0));
    awaited.noteReceipt(topic, received_s);
    for (const PlayedSample& each : drain(player)) played += each.verdict == Verdict::kAccepted ? each.accepted : 0;
  }
  int played = 0;
  AwaitedTopics awaited{player, kMost_s};
};

TEST_F(Awaited, AStalledConnectionOfAFastRecordingLosesNothing) {
  receive(0, kSecond, 0.0);
  receive(1, kSecond, 0.0);
  for (int i = 1; i <= 20; ++i) receive(0, kSecond + i * 10 * kMillisecond, 0.0005 * i);  // .2 s in 10 ms
  EXPECT_TRUE(player.isOvertaken(1));
  EXPECT_EQ(played, 2);
  for (int i = 1; i <= 20; ++i) receive(1, kSecond + i * 10 * kMillisecond, 0.011);
  EXPECT_EQ(played, 42);
  EXPECT_EQ(player.count(Verdict::kLate), 0);
  EXPECT_FALSE(awaited.isWaiting());
}

TEST_F(Awaited, ASilentTopicIsGivenUpOnceThatMuchWallTimeHasPassed) {
  receive(0, kSecond, 0.0);
  receive(1, kSecond, 0.0);
  for (int i = 1; i <= 20; ++i) receive(0, kSecond + i * 10 * kMillisecond, 0.0005 * i);
  EXPECT_TRUE(awaited.isWaiting());
  awaited.noteTime(0.049);
  EXPECT_FALSE(player.playNext());
  awaited.noteTime(0.0501);
  EXPECT_EQ(drain(player).size(), 20U);
  EXPECT_FALSE(awaited.isWaiting());
}

TEST_F(Awaited, AtTheSpeedOfTheRecordingNothingWaitsLongerThanByItsStamps) {
  receive(0, kSecond, 1.0);
  receive(1, kSecond, 1.0);
  for (int i = 1; i <= 6; ++i) receive(0, kSecond + i * 10 * kMillisecond, 1.0 + 0.0101 * i);
  EXPECT_EQ(played, 8);
}

TEST_F(Awaited, OneThatWasNeverHeardCountsFromTheFirstStateOfAll) {
  for (int i = 0; i <= 10; ++i) receive(0, kSecond + i * 10 * kMillisecond, 3.0 + 0.001 * i);
  EXPECT_EQ(played, 0);
  awaited.noteTime(3.001 + kMost_s);
  EXPECT_EQ(drain(player).size(), 11U);
}

TEST_F(Awaited, SilenceIsOfAllTopics) {
  EXPECT_FALSE(awaited.isSilent());
  receive(0, kSecond, 5.0);
  awaited.noteTime(5.049);
  EXPECT_FALSE(awaited.isSilent());
  receive(1, kSecond, 5.0495);
  awaited.noteTime(5.0501);
  EXPECT_FALSE(awaited.isSilent());
  awaited.noteTime(5.1);
  EXPECT_TRUE(awaited.isSilent());
  receive(0, kSecond + kMillisecond, 5.1);
  EXPECT_FALSE(awaited.isSilent());
}

/// A process that was stopped, or did not get to run, has the states of some connections before those of others.
TEST_F(Awaited, TimeInWhichTheProcessDidNothingDoesNotCount) {
  AwaitedTopics longer(player, 0.5);
  const auto receive_longer = [&](int topic, std::int64_t stamp_ns, double received_s) {
    player.push(topic, sample(stamp_ns, 0.0));
    longer.noteReceipt(topic, received_s);
    for (const PlayedSample& each : drain(player)) played += each.verdict == Verdict::kAccepted ? each.accepted : 0;
  };
  for (int topic : {0, 1}) receive_longer(topic, kSecond, 0.0);
  for (int topic : {0, 1}) {  // three seconds later
    for (int i = 1; i <= 20; ++i) receive_longer(topic, kSecond + i * 10 * kMillisecond, 3.0);
  }
  EXPECT_EQ(played, 42);
}

/// A clock that is behind for good is no stalled connection, however often it sends.
TEST_F(Awaited, AClockThatStaysBehindIsNotWaitedForLonger) {
  receive(0, 100 * kSecond, 0.0);
  for (int i = 1; i <= 10; ++i) {
    receive(0, 100 * kSecond + i * 10 * kMillisecond, 0.01 * i);
    receive(1, kSecond + i * 10 * kMillisecond, 0.01 * i);
  }
  EXPECT_GE(played, 10);
}

}  // namespace awaited_topics_test
}  // namespace tissue_contact
