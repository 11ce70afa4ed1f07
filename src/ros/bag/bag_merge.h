/// @file
/// Room `ros` (private): puts the messages of a bag's chunks into the order of their recording. See bag_reader.h.
#pragma once

#include <cstddef>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <tuple>
#include <vector>

#include "ros/bag/bag_reader.h"

namespace tissue_contact {

/// A time as bags store it, seconds in the low half.
/// @throws BagError when its nanoseconds are 10^9 or more.
ros::Time bagTime(std::uint64_t bits);

/// One pass over the chosen messages.
///
/// A chunk is read when the first of its messages is due, and what it has of chosen connections waits here for its turn.
/// Chunks that rosbag writes hardly overlap in time, so that hardly more than one chunk's messages wait.
class BagMerge {
 public:
  /// @param bag must outlive the pass and not select() again.
  explicit BagMerge(const BagReader& bag);

  /// Nothing at the end.
  /// @throws BagError.
  std::optional<BagMessage> next();

 private:
  using Part = BagReader::Part;
  /// Where a message stands among those of its connection: time, chunk, place in the chunk.
  using Turn = std::tuple<ros::Time, std::uint32_t, std::uint32_t>;

  struct Queue {
    const BagConnection* connection = nullptr;
    std::vector<const Part*> parts;  ///< by time of their first message, the last is first; those of read chunks, too
    std::map<Turn, std::string> waiting;
  };
  /// Of one connection in the chunk that is read.
  struct Found {
    Queue* queue = nullptr;
    const Part* part = nullptr;
    std::uint32_t count = 0;
    ros::Time first;
  };

  /// The chunk that may hold the queue's next message, or one of the same time that stands before it; null if that is
  /// here.
  const Part* missing(Queue& queue) const;
  ros::Time nextTime(Queue& queue) const;
  void insert(Queue* queue);
  void readChunk(std::uint32_t number);
  std::uint64_t readMessages(const BagReader::Chunk& chunk, std::map<std::uint32_t, Found>& wanted);
  void keep(Found& found, ros::Time time, std::uint32_t place, std::string data);

  const BagReader& bag_;
  std::map<std::uint32_t, Queue> queues_;  ///< by connection
  std::vector<Queue*> order_;              ///< by time of their next message, the last is first
  std::vector<bool> read_;                 ///< by chunk
  std::size_t waiting_bytes_ = 0;
  std::uint64_t decompressed_bytes_ = 0;
  std::string current_;  ///< data of the message handed out
};

}  // namespace tissue_contact
