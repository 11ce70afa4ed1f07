/// @file
/// Between receiving and stepping: order, bound, counts, restarts, receipt times, and numbers that are missing.
#include "ros/node/joint_state_inbox.h"

#include <gtest/gtest.h>

#include <string>
#include <thread>
#include <utility>

#include "ros/node/receipt_times.h"
#include "ros/node/sequence_gaps.h"

namespace tissue_contact {
namespace joint_state_inbox_test {

ReceivedState stateAt(std::int64_t stamp_ns, double received_s = 0.0) {
  ReceivedState state;
  state.sample.stamp_ns = stamp_ns;
  state.received_s = received_s;
  return state;
}

TEST(JointStateInbox, GivesBackInOrderAndCounts) {
  JointStateInbox inbox(10);
  EXPECT_FALSE(inbox.take());
  for (int i = 1; i <= 3; ++i) inbox.put(stateAt(i, 0.5 * i));
  EXPECT_EQ(inbox.counts().received, 3);
  EXPECT_EQ(inbox.counts().waiting, 3U);
  EXPECT_EQ(inbox.counts().oldest_received_s, 0.5);
  EXPECT_EQ(inbox.counts().newest_stamp_ns, 3);
  EXPECT_EQ(inbox.heard(2), (std::vector<std::optional<double>>{1.5, std::nullopt}));
  for (int i = 1; i <= 3; ++i) EXPECT_EQ(inbox.take()->sample.stamp_ns, i);
  EXPECT_FALSE(inbox.take());
  EXPECT_EQ(inbox.counts().waiting, 0U);
  EXPECT_EQ(inbox.counts().dropped, 0);
}

TEST(JointStateInbox, DropsTheOldestAndCountsIt) {
  JointStateInbox inbox(3);
  for (int i = 1; i <= 10; ++i) inbox.put(stateAt(i));
  EXPECT_EQ(inbox.counts().received, 10);
  EXPECT_EQ(inbox.counts().dropped, 7);
  for (int i = 8; i <= 10; ++i) EXPECT_EQ(inbox.take()->sample.stamp_ns, i);
}

TEST(JointStateInbox, IsBoundedInBytesAsWell) {
  JointStateInbox inbox(1000, 100000);
  for (int i = 1; i <= 10; ++i) {
    ReceivedState state = stateAt(i);
    state.sample.positions.resize(4000);
    inbox.put(std::move(state));
  }
  EXPECT_EQ(inbox.counts().received, 10);
  EXPECT_EQ(inbox.counts().waiting, 3U);  // of 32 kB each
  EXPECT_EQ(inbox.counts().dropped, 7);
  ReceivedState huge = stateAt(11);
  huge.sample.names.assign(2, std::string(1000000, 'n'));
  inbox.put(std::move(huge));
  EXPECT_EQ(inbox.counts().waiting, 1U);
  EXPECT_EQ(inbox.take()->sample.stamp_ns, 11);
  for (int i = 12; i <= 20; ++i) inbox.put(stateAt(i));
  EXPECT_EQ(inbox.counts().waiting, 9U);  // all room is back
}

TEST(JointStateInbox, ARestartMarksTheNextStateEvenIfThatIsDropped) {
  JointStateInbox inbox(2);
  inbox.put(stateAt(5));
  inbox.noteRestart();
  inbox.put(stateAt(1));
  inbox.put(stateAt(2));
  inbox.put(stateAt(3));  // drops 5 and 1
  EXPECT_EQ(inbox.counts().dropped, 2);
  EXPECT_TRUE(inbox.take()->after_restart);
  EXPECT_FALSE(inbox.take()->after_restart);
}

TEST(JointStateInbox, WaitEndsWithAStateOrAWake) {
  JointStateInbox inbox(2);
  std::thread sender([&] { inbox.put(stateAt(1)); });
  inbox.wait();  // the test's deadline is ctest's
  sender.join();
  EXPECT_TRUE(inbox.take());
  std::thread waker([&] { inbox.wake(); });
  inbox.wait();
  waker.join();
  EXPECT_FALSE(inbox.take());
}

TEST(JointStateInbox, WaitsNoLongerThanItIsTold) {
  JointStateInbox inbox(2);
  EXPECT_FALSE(inbox.wait(0.001));
  inbox.wake();
  EXPECT_TRUE(inbox.wait(60.0));
  inbox.put(stateAt(1));
  EXPECT_TRUE(inbox.wait(60.0));
}

TEST(JointStateInbox, LosesNothingBetweenThreads) {
  constexpr int kCount = 20000;
  JointStateInbox inbox(kCount);
  std::thread sender([&] {
    for (int i = 1; i <= kCount; ++i) inbox.put(stateAt(i));
  });
  for (int next = 1; next <= kCount;) {
    inbox.wait();
    while (const auto state = inbox.take()) ASSERT_EQ(state->sample.stamp_ns, next++);
  }
  sender.join();
  EXPECT_EQ(inbox.counts().received, kCount);
}

TEST(ReceiptTimes, GiveTheFirstReceiptOfAMoment) {
  ReceiptTimes receipts(2);
  receipts.note(0, {10, 1.0, 0.1});
  receipts.note(1, {10, 1.5, 0.6});
  receipts.note(0, {20, 2.0});
  receipts.note(0, {30, 3.0});
  EXPECT_EQ(receipts.find(10)->received_s, 1.0);
  EXPECT_EQ(receipts.take(10)->age_s, 0.1);
  EXPECT_FALSE(receipts.find(10));
  EXPECT_EQ(receipts.take(30)->received_s, 3.0);  // 20 was merged
  EXPECT_FALSE(receipts.take(20));
  EXPECT_FALSE(receipts.take(40));
}

TEST(ReceiptTimes, FollowTimeBackwards) {
  ReceiptTimes receipts(1);
  for (int i = 1; i <= 5; ++i) receipts.note(0, {10 * i, 1.0 * i});
  receipts.note(0, {10, 6.0});  // the next loop
  receipts.note(0, {20, 7.0});
  for (int i = 1; i <= 5; ++i) EXPECT_EQ(receipts.take(10 * i)->received_s, i);
  EXPECT_EQ(receipts.take(10)->received_s, 6.0);
  EXPECT_EQ(receipts.take(20)->received_s, 7.0);
}

TEST(ReceiptTimes, HoldNoMoreThanThePlayer) {
  ReceiptTimes receipts(1);
  for (std::size_t i = 1; i <= 2 * JointStatePlayer::kMaxWaiting; ++i)
    receipts.note(0, {static_cast<std::int64_t>(i), 0.0});
  EXPECT_FALSE(receipts.take(static_cast<std::int64_t>(JointStatePlayer::kMaxWaiting)));
  EXPECT_TRUE(receipts.take(static_cast<std::int64_t>(JointStatePlayer::kMaxWaiting) + 1));
}

TEST(SequenceGaps, CountWhatAPublisherNumberedAndNeverCame) {
  SequenceGaps gaps;
  for (const int sequence : {7, 8, 9, 12, 13}) gaps.note(0, "/robot", sequence);
  EXPECT_EQ(gaps.missing(), 2);
  gaps.note(0, "/robot", 1);  // started again
  gaps.note(0, "/robot", 2);
  EXPECT_EQ(gaps.missing(), 2);
  gaps.note(0, "/other", 100);  // numbers of its own
  gaps.note(1, "/robot", 50);
  EXPECT_EQ(gaps.missing(), 2);
  EXPECT_EQ(gaps.publishers(0), "/other, /robot");
  EXPECT_EQ(gaps.publishers(1), "/robot");
  EXPECT_EQ(gaps.publishers(2), "");
  gaps.note(2, "/\x1b[2J" + std::string(1000000, 'n'), 1);
  EXPECT_EQ(gaps.publishers(2).substr(0, 6), "/?[2Jn");
  EXPECT_EQ(gaps.publishers(2).size(), 100U);
  gaps.note(1, "/robot", 50);  // unnumbered
  gaps.note(1, "/robot", 60);
  EXPECT_EQ(gaps.missing(), 11);
  for (const std::uint32_t sequence : {700000, 61, 700001, 62})
    gaps.note(1, "/robot", sequence);  // a bag of two drivers
  EXPECT_EQ(gaps.missing(), 11);
}

}  // namespace joint_state_inbox_test
}  // namespace tissue_contact
