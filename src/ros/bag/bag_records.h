/// @file
/// Room `ros` (private): the records of bag format 2.0, http://wiki.ros.org/Bags/Format/2.0, one after the other. Every
/// length is checked against what is left, and against a limit, before memory is taken.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <memory>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "ros/bag/bag_bytes.h"

namespace tissue_contact {

enum class Op : std::uint8_t {
  kZeros = 0,  ///< no record: nothing but zeros, up to the end
  kMessage = 2,
  kFileHeader = 3,
  kIndex = 4,
  kChunk = 5,
  kChunkInfo = 6,
  kConnection = 7,
};

/// Fields of a header ("name=value", each after its length). Holds the bytes it refers to.
class BagFields {
 public:
  BagFields() = default;
  BagFields(const BagFields&) = delete;
  BagFields& operator=(const BagFields&) = delete;

  /// Replaces the fields.
  /// @throws BagError when the lengths do not fit.
  void parse(std::string bytes);

  bool has(std::string_view name) const { return find(name) != nullptr; }
  /// @throws BagError when there is none of that name.
  std::string_view text(std::string_view name) const;
  /// @throws BagError when there is none of that name and size.
  template <typename T>
  T number(std::string_view name) const {
    const std::string_view bytes = text(name);
    if (bytes.size() != sizeof(T)) throw BagError("header field '" + std::string(name) + "' has a wrong length");
    T value;
    std::memcpy(&value, bytes.data(), sizeof value);
    return value;
  }

 private:
  const std::string_view* find(std::string_view name) const;

  std::string bytes_;
  std::vector<std::pair<std::string_view, std::string_view>> fields_;  ///< into bytes_
};

/// Reads records forward.
class BagRecords {
 public:
  /// Longest header: those that rosbag writes have some hundred bytes, of which a topic's name is the only part that may
  /// grow.
  static constexpr std::uint32_t kMaxHeader = 1 << 16;

  /// @param source of the records.
  /// @param begin position of its first byte, for messages.
  /// @param end where it should end.
  BagRecords(std::unique_ptr<ByteSource> source, std::uint64_t begin, std::uint64_t end);

  /// Whether this record is the last.
  bool done() const { return data_position_ + data_size_ >= end_; }
  std::uint64_t position() const { return position_; }

  /// Goes to the next record, past what is left of this one, and reads its header.
  Op next();
  const BagFields& fields() const { return fields_; }

  /// Of the record's data: where they begin, how many bytes there are, how many are not read yet.
  std::uint64_t dataPosition() const { return data_position_; }
  std::uint32_t dataSize() const { return data_size_; }
  std::uint64_t dataLeft() const { return data_position_ + data_size_ - position_; }

  /// The record's data.
  /// @throws BagError when there are more than `limit` bytes, before any memory is taken.
  std::string data(std::uint32_t limit);
  /// The next number of the data.
  /// @throws BagError when they end before.
  template <typename T>
  T readNumber() {
    T value;
    if (sizeof value > dataLeft()) fail("its data end early");
    read(reinterpret_cast<char*>(&value), sizeof value);
    return value;
  }
  void skipData();
  /// Behind the last record.
  /// @throws BagError when the source goes on.
  void finish();

 private:
  void read(char* to, std::size_t size);
  bool fill();
  std::uint32_t length();
  void requireZeros();
  [[noreturn]] void fail(const std::string& why) const;

  std::unique_ptr<ByteSource> source_;
  std::vector<char> buffer_;
  std::size_t buffer_begin_ = 0;  ///< of what is not taken yet
  std::size_t buffer_end_ = 0;
  std::uint64_t position_;
  std::uint64_t end_;
  std::uint64_t record_position_ = 0;
  std::uint64_t data_position_ = 0;
  std::uint32_t data_size_ = 0;
  BagFields fields_;
};

}  // namespace tissue_contact
