/// @file
/// What of a scene is due for publishing, and when.
#include "ros/publish/snapshot_taker.h"

#include <gtest/gtest.h>

#include "support/text_scene.h"

namespace tissue_contact {
namespace snapshot_taker_test {

constexpr std::int64_t kSecond = 1'000'000'000;

TEST(SnapshotTaker, GoesOnWhereTimeGoesBack) {
  Simulator simulator = makeSimulator(blockScene() + "instruments:\n" + probeEntry("probe", "/probe", "[0, 0, 0.026]"));
  const JointStatePlayer player(simulator);
  SnapshotTaker taker(simulator, player, PublishOptions(), PublishedMesh::kRefined);
  const auto due = [&](std::int64_t stamp_ns, bool was_reset, bool was_resumed) {
    PlayedSample played;
    played.stamp_ns = stamp_ns;
    played.was_reset = was_reset;
    played.was_resumed = was_resumed;
    const BulkyTopics topics = taker.due(played, BulkyTopics());
    return topics.mesh && topics.contacts && topics.status && topics.markers;
  };
  EXPECT_TRUE(due(10 * kSecond, false, false));
  EXPECT_FALSE(due(10 * kSecond + 1000, false, false));
  EXPECT_TRUE(due(3600 * kSecond, false, false));  // a stray stamp
  EXPECT_TRUE(due(11 * kSecond, false, true));
  EXPECT_FALSE(due(11 * kSecond + 1000, false, false));
  EXPECT_TRUE(due(13 * kSecond, false, false));
  EXPECT_TRUE(due(2 * kSecond, true, false));
}

}  // namespace snapshot_taker_test
}  // namespace tissue_contact
