/// @file
/// Room `core`: a folder of files that can be made again, named by a hash of what they were made from.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

namespace tissue_contact {

/// Fowler, Noll and Vo's hash over 64-bit words. Finds damage, not forgery.
class ContentHash {
 public:
  explicit ContentHash(std::uint64_t seed) : value_(0xcbf29ce484222325u ^ seed) {}
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

/// Files of one kind, "<key><extension>", in a directory. Nothing here throws: what goes wrong costs time, not the result.
class CacheFolder {
 public:
  /// @param directory made when missing; empty: there is no cache. @param extension with its dot.
  CacheFolder(std::string directory, std::string extension);

  /// Content of a file; empty when there is none, it cannot be read, or everybody may write to the directory.
  std::string read(const std::string& key) const;

  /// Writes a file, whole or not at all, and removes the oldest beyond 256 MB in all.
  /// @return why it cannot; empty when all is well or there is no cache.
  std::string write(const std::string& key, const std::vector<std::string>& pieces) const;

  /// Path of a file, whether it exists or not.
  std::string path(const std::string& key) const;

 private:
  bool isOurs(const std::string& name, const std::string& ending) const;
  void removeOldest() const;

  std::string directory_;
  std::string extension_;
};

}  // namespace tissue_contact
