#include "tissue_contact/core/content_hash.h"

#include <algorithm>
#include <cstring>

namespace tissue_contact {

void ContentHash::add(const void* data, std::size_t bytes) {
  const char* from = static_cast<const char*>(data);
  while (bytes > 0) {
    std::uint64_t word = 0;
    const std::size_t part = std::min(bytes, sizeof word);
    std::memcpy(&word, from, part);
    value_ = (value_ ^ word) * 0x100000001b3u;
    value_ ^= value_ >> 29U;
    from += part;
    bytes -= part;
  }
}

void ContentKey::add(const void* data, std::size_t bytes) {
  first_.add(data, bytes);
  second_.add(data, bytes);
}

std::string ContentKey::digits() const {
  std::string digits;
  for (const std::uint64_t value : {first_.value(), second_.value()}) {
    for (int bit = 60; bit >= 0; bit -= 4) digits += "0123456789abcdef"[(value >> static_cast<unsigned>(bit)) & 15U];
  }
  return digits;
}

}  // namespace tissue_contact
