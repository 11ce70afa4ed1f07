/// @file
/// Room `ros` (private): ROS's serialization, read from bytes that anybody may have made. Unlike ros::serialization,
/// which takes the memory that an array's length asks for, every length is checked against what is left first.
#pragma once

#include <std_msgs/Header.h>

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>

#include "ros/bag/bag_bytes.h"

namespace tissue_contact {

class MessageReader {
 public:
  explicit MessageReader(std::string_view bytes) : bytes_(bytes) {}

  /// The next number, little-endian as it is in memory.
  /// @throws BagError when the message has ended, as all do.
  template <typename T>
  T number() {
    T value;
    std::memcpy(&value, take(sizeof value).data(), sizeof value);
    return value;
  }
  std::string text() { return std::string(take(count(1))); }
  std_msgs::Header header() {
    std_msgs::Header header;
    header.seq = number<std::uint32_t>();
    header.stamp.sec = number<std::uint32_t>();
    header.stamp.nsec = number<std::uint32_t>();
    header.frame_id = text();
    return header;
  }
  /// Length of an array whose elements have at least `element_bytes` each: they are there.
  std::size_t count(std::size_t element_bytes) {
    const std::size_t count = number<std::uint32_t>();
    if (count > bytes_.size() / element_bytes) {
      throw BagError("a length of " + std::to_string(count) + ", where " + std::to_string(bytes_.size()) +
                     " bytes are left");
    }
    return count;
  }
  /// The next bytes.
  std::string_view take(std::size_t size) {
    if (size > bytes_.size()) throw BagError("it is cut off");
    const std::string_view taken = bytes_.substr(0, size);
    bytes_.remove_prefix(size);
    return taken;
  }

 private:
  std::string_view bytes_;  ///< not read yet
};

}  // namespace tissue_contact
