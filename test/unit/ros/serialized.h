/// @file
/// Messages as bytes, to compare them: the operator== that gencpp writes is not in the messages that Ubuntu 20.04 itself has.
#pragma once

#include <ros/serialization.h>

#include <cstdint>
#include <vector>

namespace tissue_contact {

/// @param value a message, or a vector of messages.
template <typename Value>
std::vector<std::uint8_t> serialized(const Value& value) {
  std::vector<std::uint8_t> bytes(ros::serialization::serializationLength(value));
  ros::serialization::OStream stream(bytes.data(), static_cast<std::uint32_t>(bytes.size()));
  ros::serialization::serialize(stream, value);
  return bytes;
}

}  // namespace tissue_contact
