/// @file
/// JointStatePlayer on two topics: in which order their samples are played, waiting, and loops of both.
#include <utility>

#include "joint_state_player_fixture.h"

namespace tissue_contact {
namespace joint_state_order_test {

TEST_F(TwoProbes, WaitsForTheOtherTopic) {
  player.push(0, sample(kSecond, 0.0));
  EXPECT_TRUE(drain(player).empty());
  player.push(1, sample(kSecond + kMillisecond, 0.0));
  const std::vector<PlayedSample> first = drain(player);
  ASSERT_EQ(first.size(), 1U);  // the second topic's sample waits for the first's next one
  EXPECT_EQ(first[0].topic, 0);
  EXPECT_EQ(first[0].instruments, std::vector<int>{0});
  player.push(0, sample(kSecond + 10 * kMillisecond, 0.0));
  const std::vector<PlayedSample> second = drain(player);
  ASSERT_EQ(second.size(), 1U);
  EXPECT_EQ(second[0].topic, 1);
  EXPECT_EQ(second[0].instruments, std::vector<int>{1});
}

TEST_F(TwoProbes, SameStampOnTwoTopicsIsOneMoment) {
  for (int i = 0; i < 3; ++i) {
    const std::int64_t stamp = kSecond + i * 10 * kMillisecond;
    player.push(1, sample(stamp, 0.001 * i));
    EXPECT_TRUE(drain(player).empty());
    player.push(0, sample(stamp, -0.001 * i));
    const std::vector<PlayedSample> played = drain(player);
    ASSERT_EQ(played.size(), 1U);
    EXPECT_EQ(played[0].topic, 0);
    EXPECT_EQ(played[0].accepted, 2);
    EXPECT_EQ(played[0].instruments, (std::vector<int>{0, 1}));
    EXPECT_EQ(simulator->stepCount(), 10 * i);
    // Both wrenches are of this stamp, so both instruments must be where it has them.
    EXPECT_EQ(simulator->jointPositions(0).z(), -0.001 * i);
    EXPECT_EQ(simulator->jointPositions(1).z(), 0.001 * i);
  }
}

TEST_F(TwoProbes, ASampleOfAMomentAlreadyPlayedIsLate) {
  player.push(0, sample(kSecond, 0.0));
  player.push(0, sample(kSecond + 50 * kMillisecond, 0.0));
  EXPECT_EQ(drain(player).size(), 2U);  // not waited for any longer
  player.push(1, sample(kSecond, -0.001));
  const std::vector<PlayedSample> late = drain(player);
  ASSERT_EQ(late.size(), 1U);
  EXPECT_EQ(late[0].verdict, Verdict::kLate);
}

TEST_F(TwoProbes, StopsWaitingAfterMaxGapAndRefusesWhatComesLate) {
  player.push(0, sample(kSecond, 0.0));
  player.push(0, sample(kSecond + 49 * kMillisecond, 0.0));
  EXPECT_TRUE(drain(player).empty());
  player.push(0, sample(kSecond + 50 * kMillisecond, 0.0));
  EXPECT_EQ(drain(player).size(), 3U);
  player.push(1, sample(kSecond - kMillisecond, -0.001));
  const std::vector<PlayedSample> late = drain(player);
  ASSERT_FALSE(late.empty());
  EXPECT_EQ(late[0].verdict, Verdict::kLate);
  EXPECT_NE(late[0].detail.find("already at 1.050000000 s"), std::string::npos) << late[0].detail;
  EXPECT_EQ(player.count(Verdict::kLate), 1);
  EXPECT_EQ(simulator->jointPositions(1), Vector3::Zero());
}

TEST_F(TwoProbes, FinishReleasesWhatWaits) {
  player.push(0, sample(kSecond, 0.0));
  player.push(0, sample(kSecond + kMillisecond, 0.0));
  EXPECT_TRUE(drain(player).empty());
  player.finish();
  EXPECT_EQ(drain(player).size(), 2U);
}

TEST_F(TwoProbes, WaitingSamplesAreBoundedInNumber) {
  std::int64_t stamp = kSecond;
  for (std::size_t i = 0; i < JointStatePlayer::kMaxWaiting; ++i) player.push(0, sample(stamp += 1000, 0.0));
  EXPECT_TRUE(drain(player).empty());
  player.push(0, sample(stamp + 1000, 0.0));
  EXPECT_EQ(drain(player).size(), 1U);
}

/// Samples of two topics in the order of their stamps, topic 1 shifted by 3 ms.
Order twoPresses() {
  Order order;
  const std::vector<JointStateSample> a = press(kSecond, 0.006);
  const std::vector<JointStateSample> b = press(kSecond + 3 * kMillisecond, 0.005);
  for (std::size_t i = 0; i < a.size(); ++i) {
    order.emplace_back(0, a[i]);
    order.emplace_back(1, b[i]);
  }
  return order;
}

TEST_F(TwoProbes, TwoTopicsLoopTogetherWithOneReset) {
  auto order = twoPresses();
  const auto again = order;
  order.insert(order.end(), again.begin(), again.end());
  const Trace trace = run(*simulator, player, order);
  EXPECT_EQ(player.resets(), 1);
  EXPECT_EQ(player.count(Verdict::kAccepted), 120);
  const std::size_t half = trace.forces.size() / 2;
  EXPECT_TRUE(std::equal(trace.forces.begin(), trace.forces.begin() + static_cast<std::ptrdiff_t>(half),
                         trace.forces.begin() + static_cast<std::ptrdiff_t>(half)));
}

TEST_F(TwoProbes, LeftoversOfALoopArePlayedBeforeTheNextOne) {
  player.push(0, sample(5 * kSecond, 0.0));
  player.push(1, sample(5 * kSecond, 0.0));
  EXPECT_EQ(drain(player).size(), 1U);
  for (int i = 0; i < 3; ++i) player.push(0, sample(kSecond + i * kMillisecond, 0.0));  // looped
  EXPECT_TRUE(drain(player).empty());
  player.push(1, sample(5 * kSecond + 10 * kMillisecond, 0.0));  // leftover
  const std::vector<PlayedSample> leftover = drain(player);
  ASSERT_EQ(leftover.size(), 1U);
  EXPECT_EQ(leftover[0].verdict, Verdict::kAccepted);
  EXPECT_FALSE(leftover[0].was_reset);
  player.push(1, sample(kSecond, 0.0));
  const std::vector<PlayedSample> next = drain(player);
  ASSERT_EQ(next.size(), 1U);
  EXPECT_TRUE(next[0].was_reset);
  EXPECT_EQ(next[0].accepted, 2);
  EXPECT_EQ(player.resets(), 1);
}

TEST_F(TwoProbes, ATopicFirstHeardInALaterLoopJoinsIt) {
  player.push(0, sample(5 * kSecond, 0.0));
  for (int i = 0; i < 3; ++i) player.push(0, sample(kSecond + i * kMillisecond, 0.0));
  drain(player);
  player.push(1, sample(kSecond + 3 * kMillisecond, 0.0));
  player.push(0, sample(kSecond + 4 * kMillisecond, 0.0));
  drain(player);
  EXPECT_EQ(player.count(Verdict::kLate), 0);
  EXPECT_EQ(player.resets(), 1);
  EXPECT_EQ(player.count(Verdict::kAccepted), 5);  // the newest of topic 0 waits
}

TEST_F(TwoProbes, AClockSetBackALittleOnOneTopicDisturbsNeither) {
  for (int i = 0; i < 5; ++i) {
    for (const int topic : {0, 1}) player.push(topic, sample(2 * kSecond + i * 10 * kMillisecond, 0.0));
  }
  for (int i = 0; i < 5; ++i) {
    player.push(0, sample(2 * kSecond + (20 + i * 10) * kMillisecond, 0.0));
    player.push(1, sample(2 * kSecond + (50 + i * 10) * kMillisecond, 0.0));
  }
  player.finish();
  drain(player);
  EXPECT_EQ(player.resets(), 0);
  EXPECT_EQ(player.count(Verdict::kLate), 2);  // 20 and 30 ms
  EXPECT_EQ(player.count(Verdict::kDuplicateStamp), 1);
  EXPECT_EQ(player.count(Verdict::kAccepted), 17);
}

TEST_F(TwoProbes, AClockSetBackFarOnOneTopicKeepsTheOtherOneOnceItFits) {
  for (int i = 0; i < 5; ++i) {
    for (const int topic : {0, 1}) player.push(topic, sample(2 * kSecond + i * 10 * kMillisecond, 0.0));
  }
  for (int i = 0; i < 20; ++i) {  // topic 0 by 90 ms, and topic 1 after a while as well
    player.push(0, sample(2 * kSecond + (i * 10 - 40) * kMillisecond, 0.0));
    player.push(1, sample(2 * kSecond + (i < 10 ? 50 + i * 10 : i * 10 - 40) * kMillisecond, 0.0));
    drain(player);
  }
  player.finish();
  drain(player);
  EXPECT_EQ(player.resets(), 1);
  EXPECT_EQ(simulator->jointPositions(1).z(), 0.0);
  EXPECT_EQ(player.waiting(), 0);
}

}  // namespace joint_state_order_test
}  // namespace tissue_contact
