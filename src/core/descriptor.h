/// @file
/// Room `core` (private): an open file that closes itself.
#pragma once

#include <unistd.h>

#include <cstdint>
#include <limits>
#include <string>
#include <utility>

namespace tissue_contact {

class Descriptor {
 public:
  Descriptor() = default;
  explicit Descriptor(int number) : number_(number) {}
  Descriptor(Descriptor&& other) noexcept : number_(std::exchange(other.number_, -1)) {}
  Descriptor& operator=(Descriptor&& other) noexcept {
    std::swap(number_, other.number_);
    return *this;
  }
  ~Descriptor() { close(); }

  bool isOpen() const { return number_ >= 0; }
  int number() const { return number_; }
  /// False, with errno, when the system reports a failure of earlier writes.
  bool close() { return number_ < 0 || ::close(std::exchange(number_, -1)) == 0; }

 private:
  int number_ = -1;
};

struct OpenFile {
  Descriptor descriptor;
  std::uintmax_t bytes = 0;  ///< when it was opened
};

/// For reading what requireRegularFile() accepts.
/// @throws as that.
OpenFile openRegularFile(const std::string& file, const std::string& what,
                         std::uintmax_t max_bytes = std::numeric_limits<std::uintmax_t>::max());

}  // namespace tissue_contact
