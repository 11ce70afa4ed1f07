/// @file
/// Bags for tests: written by rosbag, then spoilt byte by byte.
#pragma once

#include <rosbag/bag.h>
#include <sensor_msgs/JointState.h>
#include <sys/resource.h>
#include <unistd.h>

#include <cstdint>
#include <cstring>
#include <fstream>
#include <iterator>
#include <map>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

#include "support/temporary_directory.h"

namespace tissue_contact {

inline std::string readBytes(const std::string& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

inline void writeBytes(const std::string& file, const std::string& bytes) {
  std::ofstream stream(file, std::ios::binary);
  stream << bytes;
}

/// Overwrites one byte where it stands, which takes a file system much less time than writing the file again.
inline void spoil(const std::string& file, std::size_t at, char byte) {
  std::fstream stream(file, std::ios::in | std::ios::out | std::ios::binary);
  stream.seekp(static_cast<std::streamoff>(at)).put(byte);
}

template <typename T>
std::string bytesOf(T value) {
  return {reinterpret_cast<const char*>(&value), sizeof value};
}

template <typename T>
T numberAt(const std::string& bytes, std::size_t position) {
  T value;
  std::memcpy(&value, bytes.data() + position, sizeof value);
  return value;
}

/// A record of a sound bag: where the values of its header fields and its data are.
struct RecordPlace {
  std::size_t position = 0;
  std::map<std::string, std::size_t> field;
  std::size_t data = 0;
  std::uint32_t size = 0;  ///< of the data
  int op = 0;
};

inline std::vector<RecordPlace> recordsOf(const std::string& bytes, std::size_t begin, std::size_t end) {
  std::vector<RecordPlace> records;
  for (std::size_t at = begin; at < end;) {
    RecordPlace record;
    record.position = at;
    const std::size_t header_end = at + 4 + numberAt<std::uint32_t>(bytes, at);
    for (at += 4; at < header_end; at += 4 + numberAt<std::uint32_t>(bytes, at)) {
      const std::size_t equals = bytes.find('=', at + 4);
      record.field[bytes.substr(at + 4, equals - at - 4)] = equals + 1;
    }
    record.op = bytes[record.field.at("op")];
    record.size = numberAt<std::uint32_t>(bytes, header_end);
    record.data = header_end + 4;
    at = record.data + record.size;
    records.push_back(record);
  }
  return records;
}

constexpr int kMessageOp = 2;
constexpr int kFileHeaderOp = 3;
constexpr int kIndexOp = 4;
constexpr int kChunkOp = 5;
constexpr int kChunkInfoOp = 6;
constexpr int kConnectionOp = 7;

/// The records of a kind; @param index among them. Behind the version line, 13 bytes.
inline RecordPlace recordOf(const std::string& bytes, int op, std::size_t index = 0) {
  for (const RecordPlace& record : recordsOf(bytes, 13, bytes.size())) {
    if (record.op == op && index-- == 0) return record;
  }
  throw std::runtime_error("the bag has no such record");
}

/// A message in the first chunk of a bag that is not compressed.
inline RecordPlace messageOf(const std::string& bytes, std::size_t index) {
  const RecordPlace chunk = recordOf(bytes, kChunkOp);
  for (const RecordPlace& record : recordsOf(bytes, chunk.data, chunk.data + chunk.size)) {
    if (record.op == kMessageOp && index-- == 0) return record;
  }
  throw std::runtime_error("the chunk has no such message");
}

inline std::string patched(std::string bytes, std::size_t position, const std::string& by) {
  return bytes.replace(position, by.size(), by);
}

constexpr const char* kTopic = "/arm/joint_states";

inline sensor_msgs::JointState jointState(int i) {
  sensor_msgs::JointState state;
  state.header.stamp = ros::Time(1000, 1000000U * static_cast<unsigned>(i));
  state.name = {"yaw", "pitch"};
  state.position = {0.01 * i, -0.02 * i};
  state.velocity = {10.0, -20.0 + i};
  return state;
}

/// `count` joint states on kTopic, recorded at their stamps. @param chunk_bytes how full a chunk gets.
inline void writeJointStates(const std::string& file, int count,
                             rosbag::CompressionType compression = rosbag::compression::Uncompressed,
                             std::uint32_t chunk_bytes = 768 * 1024) {
  rosbag::Bag bag(file, rosbag::bagmode::Write);
  bag.setCompression(compression);
  bag.setChunkThreshold(chunk_bytes);
  for (int i = 0; i < count; ++i) bag.write(kTopic, jointState(i).header.stamp, jointState(i));
}

/// While it lives, this process gets no more than `bytes` of memory beyond what it has. Not under a sanitizer, which
/// takes memory of its own.
class MemoryLimit {
 public:
  explicit MemoryLimit(std::size_t bytes) {
    getrlimit(RLIMIT_AS, &before_);
#if !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)
    std::size_t pages = 0;
    std::ifstream("/proc/self/statm") >> pages;
    const rlimit limit{pages * static_cast<std::size_t>(sysconf(_SC_PAGESIZE)) + bytes, before_.rlim_max};
    setrlimit(RLIMIT_AS, &limit);
#else
    static_cast<void>(bytes);
#endif
  }
  ~MemoryLimit() { setrlimit(RLIMIT_AS, &before_); }
  MemoryLimit(const MemoryLimit&) = delete;
  MemoryLimit& operator=(const MemoryLimit&) = delete;

 private:
  rlimit before_{};
};

/// For bags of some kilobytes: room for the test's own copies, and bzip2's 4 MB.
constexpr std::size_t kSmall = 16U << 20U;

}  // namespace tissue_contact
