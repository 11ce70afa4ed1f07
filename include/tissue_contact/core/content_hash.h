/// @file
/// Room `core`: hashes of content.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>

namespace tissue_contact {

/// Fowler, Noll and Vo's hash over 64-bit words. Finds damage, not forgery.
class ContentHash {
 public:
  explicit ContentHash(std::uint64_t seed = 0) : value_(0xcbf29ce484222325u ^ seed) {}
  void add(const void* data, std::size_t bytes);
  std::uint64_t value() const { return value_; }

 private:
  std::uint64_t value_;
};

/// 128 bits of hash over pieces of content, as hexadecimal digits.
class ContentKey {
 public:
  static constexpr std::size_t kDigits = 32;

  void add(const void* data, std::size_t bytes);
  std::string digits() const;

 private:
  ContentHash first_{0x51ed2701u};
  ContentHash second_{0x9e3779b9u};
};

}  // namespace tissue_contact
