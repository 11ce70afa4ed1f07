/// @file
/// Joint states of a bag: those that were recorded, in rosbag's order, and from a bag that somebody has spoilt or made
/// up nothing but an error. rosbag itself reads outside its buffers, or takes gigabytes, on most of the bags here.

#include "ros/bag/joint_state_bag.h"

#include <gtest/gtest.h>
#include <rosbag/view.h>
#include <std_msgs/String.h>
#include <sys/stat.h>

#include <functional>
#include <iostream>
#include <random>
#include <tuple>

#include "bag_fixture.h"
#include "support/refusal.h"

namespace tissue_contact {
namespace joint_state_bag_test {

using rosbag::compression::BZ2;
using rosbag::compression::LZ4;
using rosbag::compression::Uncompressed;

/// Topic, stamp, first name, positions, velocities, time of recording.
using Row = std::tuple<int, std::int64_t, std::string, std::vector<double>, std::vector<double>, std::uint64_t>;

std::vector<Row> rowsOf(const std::string& file, const std::vector<std::string>& topics = {kTopic}) {
  std::vector<Row> rows;
  JointStateBag(file, topics).forEach([&](int topic, const JointStateSample& sample, ros::Time recorded) {
    const std::string name = sample.names.empty() ? "" : sample.names.front();
    rows.emplace_back(topic, sample.stamp_ns, name, sample.positions, sample.velocities, recorded.toNSec());
  });
  return rows;
}

std::string errorOf(const std::string& file) {
  return refusal<std::runtime_error>([&] { rowsOf(file); });
}

class JointStateBagTest : public testing::Test {
 protected:
  std::string write(const std::string& name, const std::string& bytes) const {
    writeBytes(directory_.path(name), bytes);
    return directory_.path(name);
  }

  std::string sound(int count = 100, rosbag::CompressionType compression = Uncompressed,
                    std::uint32_t chunk_bytes = 768 * 1024) const {
    writeJointStates(directory_.path("sound.bag"), count, compression, chunk_bytes);
    return readBytes(directory_.path("sound.bag"));
  }

  void expectRefused(const std::string& bytes, const std::vector<std::string>& words) const {
    const std::string file = write("spoilt.bag", bytes);
    const std::string error = errorOf(file);
    expectContains(error, {"bag '" + file + "'"});
    expectContains(error, words);
  }

  TemporaryDirectory directory_;
};

/// Seeded; times of recording repeat, go back and forth across chunks, and differ from the stamps; some topics have
/// several publishers.
void writeShuffled(const std::string& file, unsigned seed, rosbag::CompressionType compression) {
  std::mt19937 random(seed);
  rosbag::Bag bag(file, rosbag::bagmode::Write);
  bag.setCompression(compression);
  bag.setChunkThreshold(700);  // some four messages
  for (int i = 0; i < 400; ++i) {
    const auto connection = static_cast<unsigned>(random() % 6);
    sensor_msgs::JointState state = jointState(i);
    state.name = {"publisher " + std::to_string(connection), "other"};
    auto header = boost::make_shared<ros::M_string>();
    (*header)["callerid"] = "/publisher" + std::to_string(connection);
    (*header)["type"] = "sensor_msgs/JointState";
    (*header)["md5sum"] = ros::message_traits::md5sum(state);
    (*header)["message_definition"] = ros::message_traits::definition(state);
    const auto time = static_cast<unsigned>(static_cast<unsigned>(i) / 10 + random() % (random() % 8 == 0 ? 30 : 3));
    bag.write("/topic" + std::to_string(connection % 3), ros::Time(100 + time / 8, 1000000 * (time % 8)), state,
              header);
  }
}

std::vector<Row> rowsOfRosbag(const std::string& file, const std::vector<std::string>& topics) {
  std::vector<Row> rows;
  const rosbag::Bag bag(file);
  rosbag::View view(bag, rosbag::TopicQuery(topics));
  for (const rosbag::MessageInstance& instance : view) {
    const auto state = instance.instantiate<sensor_msgs::JointState>();
    const int topic = static_cast<int>(std::find(topics.begin(), topics.end(), instance.getTopic()) - topics.begin());
    rows.emplace_back(topic, static_cast<std::int64_t>(state->header.stamp.toNSec()), state->name.front(),
                      state->position, state->velocity, instance.getTime().toNSec());
  }
  return rows;
}

TEST_F(JointStateBagTest, OrderIsRosbags) {
  const std::vector<std::string> topics{"/topic2", "/topic0"};
  for (const auto compression : {Uncompressed, BZ2, LZ4}) {
    for (unsigned seed = 0; seed < 30; ++seed) {
      const std::string file = directory_.path("shuffled.bag");
      writeShuffled(file, seed, compression);
      const std::vector<Row> expected = rowsOfRosbag(file, topics);
      ASSERT_GT(expected.size(), 200u);
      ASSERT_EQ(rowsOf(file, topics), expected) << "seed " << seed << ", compression " << compression;
      const rosbag::Bag bag(file);
      rosbag::View view(bag, rosbag::TopicQuery(topics));
      const JointStateBag ours(file, topics);
      EXPECT_EQ(ours.begin(), view.getBeginTime());
      EXPECT_EQ(ours.end(), view.getEndTime());
    }
  }
}

TEST_F(JointStateBagTest, RecordingOfARealRobotIsRosbags) {
  const std::string file = TISSUE_CONTACT_SHARED_DATA "/dvrk/psm2_classic_motion.bag";
  if (!std::filesystem::exists(file)) GTEST_SKIP() << "no recording at " << file;
  const std::vector<std::string> topics{"/PSM2/measured_js", "/PSM2/setpoint_js"};
  EXPECT_EQ(rowsOf(file, topics), rowsOfRosbag(file, topics));
}

TEST_F(JointStateBagTest, MessagesOfOtherTopicsArePassedOver) {
  const std::string file = directory_.path("camera.bag");
  {
    rosbag::Bag bag(file, rosbag::bagmode::Write);
    bag.setChunkThreshold(1 << 16);
    std_msgs::String image;
    image.data.assign(1 << 20, 'x');
    for (int i = 0; i < 30; ++i) {
      bag.write("/camera", jointState(i).header.stamp, image);
      bag.write(kTopic, jointState(i).header.stamp, jointState(i));
    }
  }
  EXPECT_EQ(rowsOf(file), rowsOfRosbag(file, {kTopic}));
}

TEST_F(JointStateBagTest, FileThatIsNoBag) {
  const std::string none = directory_.path("none.bag");
  EXPECT_EQ(errorOf(none), "bag '" + none + "' does not exist; correct the path");
  expectRefused("", {"empty"});
  expectRefused("not a bag, but a text", {"no ROS bag"});
  expectRefused("#ROSBAG V2.0\n", {"cut off"});
  expectRefused(patched(sound(), 0, "#ROSBAG V1.2\n"), {"format 1.2", "rosbag filter"});
  // None of these may be waited for or read without end.
  const std::string pipe = directory_.path("pipe");
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  for (const std::string& file : {pipe, directory_.path(""), std::string("/dev/zero")}) {
    expectContains(errorOf(file), {"bag '" + file + "' is not a regular file"});
  }
}

/// A length of 2^28 in a bag of some kilobytes was 8.4 GB.
TEST_F(JointStateBagTest, LengthsInAMessageAreCheckedBeforeMemoryIsTaken) {
  const std::string bytes = sound();
  const RecordPlace message = messageOf(bytes, 50);
  // After sequence number, stamp and the empty frame's length: count of names, "yaw", "pitch", counts of positions, velocities, efforts.
  const std::size_t names = message.data + 16;
  const std::size_t positions = names + 4 + 4 + 3 + 4 + 5;
  const std::size_t velocities = positions + 4 + 16, efforts = velocities + 4 + 16;
  ASSERT_EQ(numberAt<std::uint32_t>(bytes, names), 2u);
  ASSERT_EQ(numberAt<std::uint32_t>(bytes, positions), 2u);
  const MemoryLimit limit(kSmall);
  for (const std::size_t place : {names - 4, names, names + 4, positions, velocities, efforts}) {
    for (const std::uint32_t length : {1U << 28U, 0xffffffffU}) {
      expectRefused(patched(bytes, place, bytesOf(length)),
                    {kTopic, "1000.05", std::to_string(length), "copy it again"});
    }
  }
}

TEST_F(JointStateBagTest, LengthsInRecords) {
  const std::string bytes = sound();
  const RecordPlace chunk = recordOf(bytes, kChunkOp);
  const RecordPlace message = messageOf(bytes, 50);
  const RecordPlace last = messageOf(bytes, 99);
  const MemoryLimit limit(kSmall);
  for (const std::uint32_t length : {0x00ffffffU, 0x7fffffffU, 0xffffffffU}) {
    const std::string number = bytesOf(length);
    expectRefused(patched(bytes, message.position, number), {"chunk at byte", std::to_string(length), "copy it again"});
    expectRefused(patched(bytes, message.position + 4, number), {"header field", "copy it again"});
    expectRefused(patched(bytes, message.data - 4, number), {"chunk at byte", std::to_string(length)});
    expectRefused(patched(bytes, last.data - 4, number), {"chunk at byte", std::to_string(length)});
    expectRefused(patched(bytes, chunk.position, number), {std::to_string(length)});
    expectRefused(patched(bytes, chunk.data - 4, number), {std::to_string(length)});
    expectRefused(patched(bytes, chunk.field.at("size"), number), {"chunk at byte", std::to_string(length)});
  }
  expectRefused(patched(bytes, last.data - 4, bytesOf(last.size - 4)), {"cut off"});
  expectRefused(patched(bytes, last.data - 4, bytesOf(last.size + 1)), {"chunk at byte"});
  expectRefused(patched(bytes, message.field.at("op"), "\x03"), {"chunk at byte", "no message"});
  expectRefused(patched(bytes, message.field.at("time"), bytesOf(~std::uint64_t{0})), {"4294967295 ns"});
}

/// An offset beyond its chunk was a segmentation fault.
TEST_F(JointStateBagTest, IndexThatDoesNotFit) {
  const std::string bytes = sound(300, Uncompressed, 4000);
  const RecordPlace index = recordOf(bytes, kIndexOp, 1);
  const RecordPlace connection = recordOf(bytes, kConnectionOp);
  const std::size_t head = 13;
  const RecordPlace header = recordsOf(bytes, head, bytes.size()).front();
  const std::string too_many = bytesOf(0xffffffffU);
  expectRefused(patched(bytes, index.data + 12 * 5 + 8, bytesOf(0x7fffffffU)), {"beyond its chunk", "reindex"});
  expectRefused(patched(bytes, index.data + 12 * 5 + 8, bytesOf(9000U)), {"beyond its chunk", "reindex"});
  expectRefused(patched(bytes, index.field.at("count"), too_many), {"count", "reindex"});
  expectRefused(patched(bytes, index.field.at("count"), bytesOf(1U)), {"count", "reindex"});
  expectRefused(patched(bytes, index.field.at("ver"), bytesOf(2U)), {"version", "reindex"});
  expectRefused(patched(bytes, index.data, bytesOf(ros::Time(999, 0))), {kTopic, "index", "reindex"});
  expectRefused(patched(bytes, index.data, bytesOf(std::uint64_t{0})), {kTopic, "index", "reindex"});
  expectRefused(patched(bytes, index.data, bytesOf(~std::uint64_t{0})), {"4294967295 ns", "reindex"});
  expectRefused(patched(bytes, index.data, bytesOf(ros::Time(4000000000U, 0))), {"4000000000 s", "68 years"});
  expectRefused(patched(bytes, header.field.at("conn_count"), too_many), {"4294967295", "reindex"});
  expectRefused(patched(bytes, header.field.at("chunk_count"), too_many), {"4294967295", "reindex"});
  expectRefused(patched(bytes, header.field.at("index_pos"), bytesOf(std::uint64_t{0})), {"no index", "reindex"});
  expectRefused(patched(bytes, header.field.at("index_pos"), bytesOf(std::uint64_t{1} << 62U)), {"cut off", "reindex"});
  expectRefused(patched(bytes, header.field.at("index_pos"), bytesOf(~std::uint64_t{0})), {"cut off", "reindex"});
  expectRefused(patched(bytes, index.field.at("conn"), bytesOf(7U)), {"not listed", "reindex"});
  expectRefused(patched(bytes, connection.field.at("topic") - 6, "t0pic"), {"'topic' is missing", "reindex"});
  expectRefused(patched(bytes, bytes.find("md5sum=", connection.data), "md5sun="), {"'md5sum' is missing", "reindex"});
}

/// A chunk whose index names another connection would lose its joint states without a word.
TEST_F(JointStateBagTest, IndexOfAnotherConnection) {
  {
    rosbag::Bag bag(directory_.path("two.bag"), rosbag::bagmode::Write);
    bag.setChunkThreshold(4000);
    bag.write("/other", ros::Time(999), jointState(0));
    for (int i = 0; i < 100; ++i) bag.write(kTopic, jointState(i).header.stamp, jointState(i));
  }
  const std::string bytes = readBytes(directory_.path("two.bag"));
  expectRefused(patched(bytes, recordOf(bytes, kIndexOp, 2).field.at("conn"), bytesOf(0U)), {kTopic, "100", "reindex"});
}

/// What rosbag does not look at either: joint states are found by reading the chunks.
TEST_F(JointStateBagTest, SummaryOfChunksIsNotNeeded) {
  const std::string bytes = sound(300, Uncompressed, 4000);
  const std::vector<Row> rows = rowsOf(directory_.path("sound.bag"));
  const RecordPlace summary = recordOf(bytes, kChunkInfoOp, 1);
  for (const char* field : {"chunk_pos", "start_time", "end_time"}) {  // a range of time back to front, too
    const std::string file = write("spoilt.bag", patched(bytes, summary.field.at(field), bytesOf(~std::uint64_t{0})));
    EXPECT_EQ(rowsOf(file), rows) << field;
  }
}

TEST_F(JointStateBagTest, TypeAndDefinition) {
  const std::string bytes = sound();
  const std::string sum = ros::message_traits::md5sum<sensor_msgs::JointState>();
  std::string other = bytes;
  for (std::size_t at = 0; (at = other.find(sum, at)) != std::string::npos;) other[at] = '!';
  expectRefused(other, {kTopic, "another definition", "!" + sum.substr(1), sum});
  {
    rosbag::Bag bag(directory_.path("strings.bag"), rosbag::bagmode::Write);
    bag.write(kTopic, ros::Time(1), std_msgs::String());
  }
  expectRefused(readBytes(directory_.path("strings.bag")), {kTopic, "std_msgs/String", "sensor_msgs/JointState"});
  {
    rosbag::Bag bag(directory_.path("others.bag"), rosbag::bagmode::Write);
    bag.write("/other", ros::Time(1), jointState(1));
  }
  expectRefused(readBytes(directory_.path("others.bag")), {kTopic, "/other"});
}

TEST_F(JointStateBagTest, OneTopicSpelledInTwoWays) {
  writeJointStates(directory_.path("plain.bag"), 3);
  const std::string name(kTopic);
  expectRefusal<std::runtime_error>(
      [&] {
        JointStateBag(directory_.path("plain.bag"), {name, name.substr(1)});
      },
      {"plain.bag", name + " and " + name.substr(1), "spell them alike"});
}

/// Names in a bag are anybody's: they neither fill a log nor steer a terminal.
TEST_F(JointStateBagTest, NamesInMessagesArePrintable) {
  const auto write_strings = [this](const std::vector<std::string>& topics) {
    rosbag::Bag bag(directory_.path("names.bag"), rosbag::bagmode::Write);
    for (const std::string& topic : topics) bag.write(topic, ros::Time(1), std_msgs::String());
  };
  const auto error_of = [this](const std::string& bytes) {
    const std::string error = errorOf(write("spoilt.bag", bytes));
    for (const char c : error) EXPECT_GE(static_cast<unsigned char>(c), 0x20) << error;
    EXPECT_LT(error.size(), 10000u);
    return error;
  };
  write_strings({"/red\x1b[31m", "/" + std::string(1000, 'x')});
  EXPECT_NE(error_of(readBytes(directory_.path("names.bag"))).find("/red?[31m, /xxx"), std::string::npos);
  std::vector<std::string> many;
  for (int i = 0; i < 1000; ++i) many.push_back("/topic" + std::to_string(i));
  write_strings(many);
  EXPECT_NE(error_of(readBytes(directory_.path("names.bag"))).find(", ..."), std::string::npos);
  write_strings({kTopic});
  std::string bytes = readBytes(directory_.path("names.bag"));
  for (std::size_t at = 0; (at = bytes.find("std_msgs", at)) != std::string::npos;) bytes[at] = '\x1b';
  EXPECT_NE(error_of(bytes).find("?td_msgs/String"), std::string::npos);
}

TEST_F(JointStateBagTest, LongNamesAreRefused) {
  const auto bytes_of = [this](const char* field, std::size_t size) {
    auto header = boost::make_shared<ros::M_string>();
    (*header)["type"] = "sensor_msgs/JointState";
    (*header)["md5sum"] = ros::message_traits::md5sum<sensor_msgs::JointState>();
    (*header)["message_definition"] = ros::message_traits::definition<sensor_msgs::JointState>();
    (*header)[field] = std::string(size, 'x');
    const bool is_topic = std::string(field) == "topic";
    rosbag::Bag bag(directory_.path("long.bag"), rosbag::bagmode::Write);
    bag.write(kTopic, ros::Time(1), jointState(1));
    bag.write(is_topic ? (*header)[field] : "/other", ros::Time(2), jointState(2), header);
    bag.close();
    return readBytes(directory_.path("long.bag"));
  };
  for (const char* field : {"topic", "type", "md5sum"}) {
    expectRefused(bytes_of(field, 1025), {field, "1025 bytes", "at most 1024"});
    EXPECT_EQ(rowsOf(write("sound.bag", bytes_of(field, 1024))).size(), 1u) << field;
  }
}

/// The player refuses such a stamp and counts it; the messages before and behind it are played.
TEST_F(JointStateBagTest, ImpossibleStampIsHandedOver) {
  const std::string bytes = sound();
  const std::string all_ones = bytesOf(~std::uint64_t{0});
  const std::vector<Row> rows = rowsOf(write("spoilt.bag", patched(bytes, messageOf(bytes, 50).data + 4, all_ones)));
  ASSERT_EQ(rows.size(), 100u);
  constexpr std::int64_t kLastStamp_ns = 4294967295999999999;  // of ROS time
  EXPECT_GT(std::get<1>(rows[50]), kLastStamp_ns);
  EXPECT_EQ(std::get<1>(rows[51]), 1000051000000);
}

class CompressedBag : public JointStateBagTest, public testing::WithParamInterface<rosbag::CompressionType> {};

INSTANTIATE_TEST_SUITE_P(AllKinds, CompressedBag, testing::Values(Uncompressed, BZ2, LZ4));

TEST_P(CompressedBag, CutAtEveryPercent) {
  const std::string bytes = sound(400, GetParam(), 4000);
  const std::vector<Row> rows = rowsOf(directory_.path("sound.bag"));
  ASSERT_EQ(rows.size(), 400u);
  const RecordPlace first_chunk = recordOf(bytes, kChunkOp);
  const MemoryLimit limit(kSmall);
  for (std::size_t percent = 1; percent < 100; ++percent) {
    SCOPED_TRACE(percent);
    const std::string cut = bytes.substr(0, bytes.size() * percent / 100);
    if (cut.size() < first_chunk.position) {
      expectRefused(cut, {"copy it again"});  // reindexing has nothing to work on
    } else if (cut.size() < first_chunk.data + first_chunk.size) {
      expectRefused(cut, {"cut off", "nothing can be recovered"});
    } else {
      expectRefused(cut, {"cut off", "rosbag reindex"});
    }
  }
  EXPECT_EQ(rowsOf(write("whole.bag", bytes)), rows);
}

/// Where the index lies, byte by byte.
TEST_P(CompressedBag, CutInTheIndex) {
  const std::string bytes = sound(400, GetParam(), 4000);
  const std::size_t index = recordOf(bytes, kConnectionOp).position;
  const std::string file = write("cut.bag", bytes);
  for (std::size_t size = bytes.size() - 1; size >= index; --size) {
    std::filesystem::resize_file(file, size);
    const std::string error = errorOf(file);
    ASSERT_EQ(error.find("bag '" + file + "': its index is cut off or damaged"), 0u) << size << ": " << error;
    ASSERT_NE(error.find("rosbag reindex"), std::string::npos) << error;
  }
}

#ifdef __SANITIZE_ADDRESS__
constexpr std::size_t kBytesApart = 13;  // it takes a hundred times as long
#else
constexpr std::size_t kBytesApart = 1;
#endif

/// Two bits of each byte in turn: an error that names the file, or as many joint states as there were.
TEST_P(CompressedBag, EveryByteSpoilt) {
  const std::string bytes = sound(60, GetParam(), 4000);
  const std::string file = write("spoilt.bag", bytes);
  const MemoryLimit limit(kSmall);
  std::size_t refused = 0;
  for (std::size_t at = 0; at < bytes.size(); at += kBytesApart) {
    if (bytes[at] == ' ') continue;  // padding of the header
    for (const char mask : {'\x01', '\x40'}) {
      spoil(file, at, static_cast<char>(bytes[at] ^ mask));
      try {
        ASSERT_EQ(rowsOf(file).size(), 60u) << "byte " << at;
      } catch (const std::runtime_error& error) {
        ASSERT_EQ(std::string(error.what()).find("bag '" + file + "': "), 0u) << error.what();
        ++refused;
      }
    }
    spoil(file, at, bytes[at]);
  }
  EXPECT_EQ(rowsOf(file).size(), 60u);
  EXPECT_GT(refused, 1000 / kBytesApart);  // lengths, kinds, names; what is left are values
}

}  // namespace joint_state_bag_test
}  // namespace tissue_contact
