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
  EXPECT_FALSE(awaited.nextEnd());
}

TEST_F(Awaited, ASilentTopicIsGivenUpOnceThatMuchWallTimeHasPassed) {
  receive(0, kSecond, 0.0);
  receive(1, kSecond, 0.0);
  for (int i = 1; i <= 20; ++i) receive(0, kSecond + i * 10 * kMillisecond, 0.0005 * i);
  ASSERT_TRUE(awaited.nextEnd());
  EXPECT_EQ(*awaited.nextEnd(), kMost_s);
  awaited.noteTime(0.049);
  EXPECT_FALSE(player.playNext());
  awaited.noteTime(0.05);
  EXPECT_EQ(drain(player).size(), 20U);
  EXPECT_FALSE(awaited.nextEnd());
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
  awaited.noteTime(3.0 + kMost_s);
  EXPECT_EQ(drain(player).size(), 11U);
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
