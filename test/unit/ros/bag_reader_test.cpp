/// @file
/// What a bag may ask for: each limit, and that memory follows neither what is claimed nor what is decompressed.

#include "ros/bag/bag_reader.h"

#include <gtest/gtest.h>
#include <std_msgs/String.h>

#include <filesystem>
#include <fstream>
#include <string>

#include "bag_fixture.h"
#include "support/refusal.h"

namespace tissue_contact {
namespace bag_reader_test {

using rosbag::compression::BZ2;
using rosbag::compression::LZ4;

class BagReaderTest : public testing::Test {
 protected:
  std::size_t read(const BagLimits& limits) const {
    std::size_t count = 0;
    BagReader bag(file_, limits);
    bag.select([](const BagConnection& connection) { return connection.topic == kTopic; });
    bag.forEach([&](const BagMessage&) { return ++count > 0; });
    return count;
  }

  /// The bytes of all messages.
  std::string readAll() const {
    std::string messages;
    BagReader bag(file_);
    bag.select([](const BagConnection&) { return true; });
    bag.forEach([&](const BagMessage& message) {
      messages += message.data;
      return true;
    });
    return messages;
  }

  void expectRefused(const BagLimits& limits, const std::string& words) const {
    const std::string error = refusal<std::runtime_error>([&] { read(limits); });
    EXPECT_EQ(error.find("bag '" + file_ + "': "), 0u) << error;
    expectContains(error, {words});
  }

  /// A joint state behind `bytes` of another topic that compress to almost nothing.
  void writeBomb(std::size_t bytes, rosbag::CompressionType compression) const {
    rosbag::Bag bag(file_, rosbag::bagmode::Write);
    bag.setCompression(compression);
    std_msgs::String zeros;
    zeros.data.assign(bytes, '\0');
    bag.setChunkThreshold(static_cast<std::uint32_t>(bytes) + 1024);  // one chunk holds both
    bag.write("/other", ros::Time(1000), zeros);
    bag.write(kTopic, ros::Time(1000), jointState(0));
  }

  TemporaryDirectory directory_;
  std::string file_ = directory_.path("test.bag");
};

TEST_F(BagReaderTest, EachLimitIsKept) {
  writeJointStates(file_, 200, BZ2, 2000);
  ASSERT_EQ(read(BagLimits()), 200u);
  const auto expectRefusedWith = [this](auto BagLimits::*limit, unsigned value, const char* words) {
    BagLimits limits;
    limits.*limit = value;
    expectRefused(limits, words);
  };
  expectRefusedWith(&BagLimits::connections, 0, "more than 0 connections");
  expectRefusedWith(&BagLimits::chunks, 3, "more than 3 chunks");
  expectRefusedWith(&BagLimits::parts, 3, "more than 3 chunks for the connections that are read");
  expectRefusedWith(&BagLimits::message_bytes, 50, "at most 50 are read");
  expectRefusedWith(&BagLimits::waiting_bytes, 1000, "more than 1000 bytes of messages");
  BagLimits limits;
  limits.free_bytes = 10000;
  limits.expansion = 0;
  expectRefused(limits, "which is more than is read");
}

/// Each chunk has one index for each connection; which came before is known by connection, in whatever order they lie.
TEST_F(BagReaderTest, ChunksHaveOneIndexForEachConnection) {
  const std::vector<std::string> topics{kTopic, "/b", "/c"};
  {
    rosbag::Bag bag(file_, rosbag::bagmode::Write);
    bag.setChunkThreshold(2000);
    for (int i = 0; i < 120; ++i)
      bag.write(topics[static_cast<std::size_t>(i) % 3], ros::Time(1000 + i), jointState(i));
  }
  ASSERT_EQ(read(BagLimits()), 40u);
  const std::string bytes = readBytes(file_);
  const auto select_all = [this] { BagReader(file_).select([](const BagConnection&) { return true; }); };
  const std::uint32_t first = numberAt<std::uint32_t>(bytes, recordOf(bytes, kIndexOp, 3).field.at("conn"));
  for (const std::size_t index : {std::size_t{4}, std::size_t{5}}) {  // of the second chunk
    writeBytes(file_, patched(bytes, recordOf(bytes, kIndexOp, index).field.at("conn"), bytesOf(first)));
    expectRefusal<std::runtime_error>(select_all, {"second of one connection"});
  }
  writeBytes(file_, bytes);
  EXPECT_NO_THROW(select_all());
}

/// As `rosbag reindex` of ROS Melodic mends a bag that ended within a chunk: what was left of that one is zeros, and the index follows it.
TEST_F(BagReaderTest, ZerosInPlaceOfAChunkThatWasCutOff) {
  writeJointStates(file_, 200, rosbag::compression::Uncompressed, 2000);
  const std::string messages = readAll();
  const std::string bytes = readBytes(file_);
  const std::size_t header = recordOf(bytes, kFileHeaderOp).field.at("index_pos");
  const auto index = numberAt<std::uint64_t>(bytes, header);
  const auto withHole = [&](const std::string& hole) {
    std::string other = patched(bytes, header, bytesOf<std::uint64_t>(index + hole.size()));
    writeBytes(file_, other.insert(index, hole));
  };
  for (const std::size_t size : {4, 8, 2095, 100000}) {
    withHole(std::string(size, '\0'));
    EXPECT_EQ(readAll(), messages) << size;
  }
  const BagLimits limits;
  for (const std::size_t at : {4, 1000, 99999}) {
    withHole(patched(std::string(100000, '\0'), at, "x"));
    expectRefused(limits, "an empty header");
  }
  withHole(std::string(3, '\0'));
  expectRefused(limits, "it is cut off");

  const std::uint64_t far = index + (1ULL << 40U);  // a sparse file, which takes no room
  writeBytes(file_, patched(bytes.substr(0, index), header, bytesOf(far)));
  std::filesystem::resize_file(file_, far);
  std::ofstream(file_, std::ios::binary | std::ios::app) << bytes.substr(index);
  expectRefused(limits, "an empty header");
}

TEST_F(BagReaderTest, ClaimedSizeOfACompressedChunkTakesNoMemory) {
  for (const auto compression : {BZ2, LZ4}) {
    writeJointStates(file_, 200, compression);
    const std::string bytes = readBytes(file_);
    const std::size_t size = recordOf(bytes, kChunkOp).field.at("size");
    const MemoryLimit limit(kSmall);
    writeBytes(file_, patched(bytes, size, bytesOf(0xffffffffU)));
    expectRefused(BagLimits(), "cut off");
    writeBytes(file_, patched(bytes, size, bytesOf(100U)));
    expectRefused(BagLimits(), "beyond its chunk");
  }
}

TEST_F(BagReaderTest, DecompressedBytesTakeNoMemory) {
  constexpr std::size_t kBytes = 64U << 20U;
  for (const auto compression : {BZ2, LZ4}) {
    writeBomb(kBytes, compression);
    ASSERT_LT(std::filesystem::file_size(file_), kBytes / 100);
    const MemoryLimit limit(kSmall);
    EXPECT_EQ(read(BagLimits()), 1u);
    BagLimits limits;
    limits.free_bytes = 1U << 20U;
    limits.expansion = 10;
    expectRefused(limits, "bytes, decompressed");
  }
}

/// A damaged bit may well spoil no more than a position, which only the checksum at the end of the data tells. (Some bits
/// have no say: tables that are not used, one of two places to copy the same bytes from.)
TEST_F(BagReaderTest, CompressedDataThatAreDamaged) {
  for (const auto compression : {BZ2, LZ4}) {
    writeJointStates(file_, 40, compression);
    const std::string bytes = readBytes(file_);
    const std::string messages = readAll();
    const RecordPlace chunk = recordOf(bytes, kChunkOp);
    writeBytes(file_, patched(bytes, chunk.field.at("compression"), "xyz"));
    expectRefused(BagLimits(), "compressed by 'xyz'");
    writeBytes(file_, bytes);
    std::size_t refused = 0;
    for (std::size_t at = chunk.data; at < chunk.data + chunk.size; ++at) {
      spoil(file_, at, static_cast<char>(bytes[at] ^ 0x10));
      try {
        ASSERT_EQ(readAll(), messages) << at;
      } catch (const std::runtime_error& error) {
        ASSERT_NE(std::string(error.what()).find("the file is damaged: copy it again"), std::string::npos)
            << error.what();
        ++refused;
      }
      spoil(file_, at, bytes[at]);
    }
    EXPECT_GT(refused, chunk.size * 9 / 10);
  }
}

}  // namespace bag_reader_test
}  // namespace tissue_contact
