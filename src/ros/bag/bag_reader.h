/// @file
/// Room `ros` (private): messages of a bag (format 2.0) by time of recording. A file that anybody may have made goes in;
/// what comes out is whole and checked, or an error says what is wrong.
///
/// Not rosbag::Bag: that takes lengths and offsets of the file at their word (it reads outside its buffers, or asks for
/// the memory they claim) and holds the index of every message of every topic. Here nothing is taken before it is
/// checked, and memory does not grow with the bag: chunks are decompressed as a stream, each once, and of their messages
/// only those of chosen connections are kept until their turn. Order is rosbag::View's.
#pragma once

#include <ros/time.h>

#include <cstddef>
#include <cstdint>
#include <functional>
#include <map>
#include <string>
#include <string_view>
#include <vector>

#include "ros/bag/bag_bytes.h"

namespace tissue_contact {

class BagRecords;

/// Who published what; several may have one topic.
struct BagConnection {
  std::string topic;
  std::string type;    ///< "sensor_msgs/JointState"
  std::string md5sum;  ///< of the type's definition
};

struct BagMessage {
  const BagConnection& connection;
  ros::Time recorded;
  std::string_view data;  ///< serialized; valid until the next message
};

/// What a bag may ask for. Beyond it, it is refused, as none that was recorded is.
struct BagLimits {
  std::size_t connections = 1 << 16;
  std::size_t chunks = 1 << 22;           ///< 3 TB in chunks of rosbag's usual size
  std::size_t parts = 1 << 22;            ///< chunks in which a chosen connection has messages, summed over these
  std::uint32_t message_bytes = 1 << 22;  ///< of a chosen connection; others may have any size
  std::size_t waiting_bytes = 1 << 28;    ///< of messages that lie in the file before others recorded earlier
  std::uint64_t free_bytes = 1ULL << 32;  ///< decompressed, whatever the size of the file; beyond that it may be
  std::uint64_t expansion = 1 << 11;      ///< so many times the size of the file
};

/// Of a topic, from / on: bags and people leave it out.
std::string globalName(const std::string& topic);

class BagReader {
 public:
  /// Reads the list of connections.
  /// @throws std::runtime_error naming the file, what is wrong and what helps.
  explicit BagReader(const std::string& file, const BagLimits& limits = BagLimits());

  const std::string& file() const { return file_; }
  /// By the bag's own number, ascending.
  const std::map<std::uint32_t, BagConnection>& connections() const { return connections_; }

  /// Chooses connections and reads where their messages are; replaces an earlier choice.
  /// @throws as the constructor.
  void select(const std::function<bool(const BagConnection&)>& wanted);

  /// In the whole bag; 0 for connections that are not chosen.
  std::uint64_t messageCount(std::uint32_t connection) const;
  /// First and last time of recording among the chosen messages; zero where there are none.
  const ros::Time& begin() const { return begin_; }
  const ros::Time& end() const { return end_; }

  /// Chosen messages by time of recording, those of one connection and time as they lie in the file.
  /// @param take returns whether to go on.
  /// @throws as the constructor; what `take` throws goes through.
  void forEach(const std::function<bool(const BagMessage&)>& take) const;

  /// @throws std::runtime_error "bag 'file': `what`".
  [[noreturn]] void fail(const std::string& what) const;
  /// For a message whose data are not what they should be.
  [[noreturn]] void fail(const BagMessage& message, const BagError& error) const;

 private:
  friend class BagMerge;

  /// Messages of one connection in one chunk.
  struct Part {
    std::uint32_t connection = 0;
    std::uint32_t chunk = 0;
    std::uint32_t count = 0;
    ros::Time first;  ///< time of recording
  };
  struct Chunk {
    std::uint64_t position = 0;  ///< of its data
    std::uint32_t stored = 0;    ///< bytes in the file
    std::uint32_t size = 0;      ///< bytes when decompressed
    std::uint32_t part = 0;      ///< its first
    Compression compression = Compression::kNone;
  };

  template <typename Work>
  auto guarded(const Work& work) const;
  void readHeader();
  std::string wholePart() const;
  void readConnections();
  void readConnection(BagRecords& records);
  void readSummary(BagRecords& records);
  void readIndex();
  void readChunk(BagRecords& records);
  void readChunkIndex(BagRecords& records);
  void readPart(BagRecords& records, Part& part);

  std::string file_;
  BagLimits limits_;
  InputFile input_;
  std::uint64_t records_position_ = 0;  ///< of the first chunk
  std::uint64_t index_position_ = 0;    ///< behind the last chunk
  std::uint32_t chunk_count_ = 0;
  std::uint32_t connection_count_ = 0;
  std::map<std::uint32_t, BagConnection> connections_;
  std::map<std::uint32_t, std::uint64_t> summed_;      ///< messages of each connection, by the chunks' summaries
  std::vector<Chunk> chunks_;                          ///< in the order of the file
  std::vector<Part> parts_;                            ///< those of the chosen connections, chunk by chunk
  std::map<std::uint32_t, std::uint64_t> counts_;      ///< messages of the chosen connections
  std::map<std::uint32_t, std::uint64_t> indexed_;     ///< those and what was recorded at time 0
  std::map<std::uint32_t, std::uint32_t> last_chunk_;  ///< of parts_, by connection
  ros::Time begin_, end_;
};

}  // namespace tissue_contact
