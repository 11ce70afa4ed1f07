/// @file
/// Snapshots between stepping and publishing: bounded, reused, dropped with a count, never waited for.
#include "ros/publish/scene_snapshot.h"

#include <gtest/gtest.h>

#include <set>
#include <thread>
#include <utility>

namespace tissue_contact {
namespace scene_snapshot_test {

void put(SnapshotQueue& queue, std::int64_t stamp_ns) {
  std::unique_ptr<SceneSnapshot> snapshot = queue.buffer();
  snapshot->stamp_ns = stamp_ns;
  queue.put(std::move(snapshot));
}

TEST(SnapshotQueue, GivesBackInOrder) {
  SnapshotQueue queue(4);
  for (int i = 1; i <= 4; ++i) put(queue, i);
  for (int i = 1; i <= 4; ++i) EXPECT_EQ(queue.take()->stamp_ns, i);
  EXPECT_EQ(queue.dropped(), 0);
}

TEST(SnapshotQueue, DropsTheOldestWhenNobodyTakes) {
  SnapshotQueue queue(3);
  for (int i = 1; i <= 10; ++i) put(queue, i);
  EXPECT_EQ(queue.dropped(), 7);
  for (int i = 8; i <= 10; ++i) EXPECT_EQ(queue.take()->stamp_ns, i);
}

TEST(SnapshotQueue, ReusesItsBuffersAndTheirMemory) {
  SnapshotQueue queue(2);
  std::set<const SceneSnapshot*> buffers;
  for (int i = 0; i < 100; ++i) {
    std::unique_ptr<SceneSnapshot> snapshot = queue.buffer();
    buffers.insert(snapshot.get());
    EXPECT_FALSE(snapshot->topologies || snapshot->mesh || snapshot->contact_array || snapshot->markers ||
                 snapshot->with_status);
    snapshot->mesh = snapshot->with_status = true;
    snapshot->positions.resize(1);
    queue.put(std::move(snapshot));
    if (i % 3 == 0) queue.recycle(queue.take());
  }
  EXPECT_LE(buffers.size(), 4U);  // those that wait, one that is filled in, one that is read
}

/// What a subscriber who comes late is to find must not get lost with a snapshot that nobody had time for.
TEST(SnapshotQueue, TopologiesOfADroppedSnapshotAreShownByTheNext) {
  SnapshotQueue queue(1);
  std::unique_ptr<SceneSnapshot> with_mesh = queue.buffer();
  with_mesh->topologies = true;
  with_mesh->revisions.resize(1);
  queue.put(std::move(with_mesh));
  put(queue, 2);
  put(queue, 3);
  EXPECT_EQ(queue.dropped(), 2);
  std::unique_ptr<SceneSnapshot> newest = queue.take();
  EXPECT_EQ(newest->stamp_ns, 3);
  EXPECT_TRUE(newest->topologies);
  EXPECT_EQ(newest->revisions.size(), 1U);
  queue.recycle(std::move(newest));
  newest = queue.buffer();
  EXPECT_FALSE(newest->topologies);
  EXPECT_TRUE(newest->revisions.empty());  // a buffer that waits keeps no mesh alive
}

TEST(SnapshotQueue, CloseEndsTheWait) {
  SnapshotQueue queue(2);
  std::thread reader([&] { EXPECT_EQ(queue.take(), nullptr); });
  queue.close();
  reader.join();
  put(queue, 1);
  EXPECT_EQ(queue.take(), nullptr);
}

TEST(SnapshotQueue, LosesNothingBetweenThreadsThatKeepUp) {
  constexpr int kCount = 10000;
  SnapshotQueue queue(kCount);
  std::thread writer([&] {
    for (int i = 1; i <= kCount; ++i) put(queue, i);
  });
  for (int i = 1; i <= kCount; ++i) {
    std::unique_ptr<SceneSnapshot> snapshot = queue.take();
    ASSERT_EQ(snapshot->stamp_ns, i);
    queue.recycle(std::move(snapshot));
  }
  writer.join();
  EXPECT_EQ(queue.dropped(), 0);
}

}  // namespace scene_snapshot_test
}  // namespace tissue_contact
