/// @file
/// Poses from the /tf of a bag, which is trusted as little as its joint states.

#include "ros/bag/bag_frames.h"

#include <gtest/gtest.h>
#include <tf2_msgs/TFMessage.h>

#include <cmath>
#include <limits>

#include "bag_fixture.h"
#include "support/refusal.h"

namespace tissue_contact {
namespace bag_frames_test {

tf2_msgs::TFMessage transform(const std::string& parent, const std::string& child, double z_m, unsigned stamp_s) {
  tf2_msgs::TFMessage message;
  message.transforms.resize(1);
  message.transforms[0].header.stamp = ros::Time(stamp_s);
  message.transforms[0].header.frame_id = parent;
  message.transforms[0].child_frame_id = child;
  message.transforms[0].transform.translation.z = z_m;
  message.transforms[0].transform.rotation.w = 1.0;
  return message;
}

class BagFramesTest : public testing::Test {
 protected:
  BagFramesTest() {
    rosbag::Bag bag(file_, rosbag::bagmode::Write);
    bag.write("/tf", ros::Time(1000), transform("base", "tool", 0.25, 1000));
    bag.write("/tf", ros::Time(1001), transform("base", "tool", 0.5, 1001));  // comes too late
    bag.write("/tf_static", ros::Time(1002), transform("world", "base", 1.0, 1000));
  }

  std::string errorOf(const std::string& bytes) const {
    writeBytes(file_, bytes);
    return refusal<std::exception>([&] { frameInBag("tool", "world", file_); });
  }

  TemporaryDirectory directory_;
  std::string file_ = directory_.path("frames.bag");
};

TEST_F(BagFramesTest, EarliestPoseIsTaken) { EXPECT_EQ(frameInBag("tool", "world", file_).translation().z(), 1.25); }

TEST_F(BagFramesTest, UnknownFrameAndMissingBag) {
  expectRefusal([&] { frameInBag("stage", "world", file_); }, {"stage", file_});
  EXPECT_THROW(frameInBag("tool", "world", directory_.path("none.bag")), std::runtime_error);
}

TEST_F(BagFramesTest, LengthsAreCheckedBeforeMemoryIsTaken) {
  const std::string bytes = readBytes(file_);
  const RecordPlace message = messageOf(bytes, 0);
  ASSERT_EQ(numberAt<std::uint32_t>(bytes, message.data), 1u);
  const MemoryLimit limit(kSmall);
  for (const std::size_t place : {message.data, message.data + 16}) {  // of the array, of the frame's name
    for (const std::uint32_t length : {1U << 28U, 0xffffffffU}) {
      const std::string error = errorOf(patched(bytes, place, bytesOf(length)));
      EXPECT_EQ(error.find("bag '" + file_ + "': message on /tf"), 0u) << error;
      EXPECT_NE(error.find(std::to_string(length)), std::string::npos) << error;
    }
  }
}

/// What tf2 or the arithmetic of ros::Time does not take is left out: the later message is used instead.
TEST_F(BagFramesTest, ImpossibleTransformsAreLeftOut) {
  const std::string bytes = readBytes(file_);
  const RecordPlace message = messageOf(bytes, 0);
  const std::size_t z = message.data + message.size - 5 * sizeof(double);
  ASSERT_EQ(numberAt<double>(bytes, z), 0.25);
  writeBytes(file_, patched(bytes, z, bytesOf(std::numeric_limits<double>::quiet_NaN())));
  EXPECT_EQ(frameInBag("tool", "world", file_).translation().z(), 1.5);
  writeBytes(file_, patched(bytes, message.data + 8, bytesOf(~std::uint64_t{0})));
  EXPECT_NO_THROW(frameInBag("tool", "world", file_));
}

/// tf2 would keep the names of all frames: of a thousand such transforms, 100 MB.
TEST_F(BagFramesTest, LongNamesOfFramesAreLeftOutAndCounted) {
  {
    rosbag::Bag bag(file_, rosbag::bagmode::Write);
    bag.setCompression(rosbag::compression::LZ4);
    for (unsigned i = 0; i < 1000; ++i) {
      bag.write("/tf_static", ros::Time(1000 + i),
                transform("base", std::string(100000, 'x') + std::to_string(i), 0.25, 1000));
    }
    bag.write("/tf_static", ros::Time(3000), transform(std::string(257, 'p'), "lost", 0.5, 1000));
    bag.write("/tf_static", ros::Time(3001), transform("world", std::string(256, 'c'), 0.5, 1000));
  }
  const MemoryLimit limit(kSmall);
  EXPECT_EQ(frameInBag(std::string(256, 'c'), "world", file_).translation().z(), 0.5);
  expectRefusal([&] { frameInBag("lost", "world", file_); },
                {"1001 transforms with names of frames longer than 256 bytes"});
}

/// There and back again, through a frame between them, and where a frame above them both moves: nothing between the two does then.
TEST_F(BagFramesTest, FarthestThatAFrameIsFromWhereItWasFirst) {
  EXPECT_EQ(farthestInBag("tool", "world", file_).way_m, 0.25);
  {
    rosbag::Bag bag(file_, rosbag::bagmode::Append);
    bag.write("/tf", ros::Time(1010), transform("base", "tool", 0.25, 1010));
    bag.write("/tf", ros::Time(1011), transform("base", "other", 9.0, 1011));
    bag.write("/tf", ros::Time(1012), transform("map", "world", 9.0, 1012));
    bag.write("/tf", ros::Time(1013), transform("map", "world", 3.0, 1013));
  }
  const FrameMotion motion = farthestInBag("tool", "world", file_);
  EXPECT_EQ(motion.way_m, 0.25);
  EXPECT_EQ(motion.turn_rad, 0.0);
  EXPECT_TRUE(motion.counts());
  EXPECT_FALSE(farthestInBag("base", "world", file_).counts());
  EXPECT_FALSE(farthestInBag("tool", "world", file_, ros::Time(1000, 5)).counts());
}

TEST_F(BagFramesTest, FarthestTurnCounts) {
  {
    rosbag::Bag bag(file_, rosbag::bagmode::Append);
    tf2_msgs::TFMessage turned = transform("base", "tool", 0.25, 1020);
    turned.transforms[0].transform.rotation.x = 1.0;  // by 90 degrees, of no length that tf2 takes
    turned.transforms[0].transform.rotation.w = 1.0;
    bag.write("/tf", ros::Time(1020), turned);
  }
  EXPECT_NEAR(farthestInBag("tool", "world", file_).turn_rad, M_PI_2, 1e-12);
}

/// What goes round, stands on itself or is no pose ends neither the search nor the process.
TEST_F(BagFramesTest, FarthestOfImpossibleFrames) {
  {
    rosbag::Bag bag(file_, rosbag::bagmode::Append);
    tf2_msgs::TFMessage nothing = transform("base", "tool", 9.0, 1030);
    nothing.transforms[0].transform.rotation.w = 0.0;
    bag.write("/tf", ros::Time(1030), nothing);
    bag.write("/tf", ros::Time(1031), transform("tool", "base", 9.0, 1031));
    bag.write("/tf", ros::Time(1032), transform("tool", "tool", 9.0, 1032));
  }
  EXPECT_EQ(farthestInBag("tool", "world", file_).way_m, 0.25);
}

/// tf2 knows such a tool in the world; whoever asks what is above the world would ask for ever.
TEST_F(BagFramesTest, FramesAboveTheWorldThatGoRound) {
  {
    rosbag::Bag bag(file_, rosbag::bagmode::Write);
    bag.write("/tf_static", ros::Time(1000), transform("world", "tool", 0.5, 1000));
    bag.write("/tf_static", ros::Time(1001), transform("x", "world", 1.0, 1000));
    bag.write("/tf_static", ros::Time(1002), transform("world", "x", 1.0, 1000));
  }
  EXPECT_EQ(frameInBag("tool", "world", file_).translation().z(), 0.5);
  EXPECT_NO_THROW(farthestInBag("tool", "world", file_));
}

TEST_F(BagFramesTest, SlashesInFrontOfNamesMakeNoDifference) {
  {
    rosbag::Bag bag(file_, rosbag::bagmode::Write);
    bag.write("/tf", ros::Time(1000), transform("/world", "/tool", 0.25, 1000));
    bag.write("/tf", ros::Time(1001), transform("/world", "/tool", 0.5, 1001));
  }
  EXPECT_EQ(farthestInBag("tool", "world", file_).way_m, 0.25);
}

/// A linkage whose two transforms take each other back within one message has not moved.
TEST_F(BagFramesTest, TransformsOfOneMessageBelongTogether) {
  {
    rosbag::Bag bag(file_, rosbag::bagmode::Write);
    for (unsigned k = 0; k < 3; ++k) {
      tf2_msgs::TFMessage both = transform("world", "base", 0.1 * k, 1000 + k);
      both.transforms.push_back(transform("base", "tool", 1.0 - 0.1 * k, 1000 + k).transforms[0]);
      bag.write("/tf", ros::Time(1000 + k), both);
    }
  }
  EXPECT_FALSE(farthestInBag("tool", "world", file_).counts());
}

}  // namespace bag_frames_test
}  // namespace tissue_contact
