/// @file
/// Fuzz targets: what they share. A target turns the fuzzer's bytes into one kind of input, lets the library read it, and
/// allows two ends only: an answer that holds what its header promises, or std::invalid_argument.
#pragma once

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <string_view>

#include "support/temporary_directory.h"

/// libFuzzer calls it with every input; run_files.cpp with every stored one.
extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace tissue_contact::fuzz {

/// A broken promise: the fuzzer keeps the input.
inline void require(bool holds, const char* promise) {
  if (holds) return;
  std::fprintf(stderr, "broken promise: %s\n", promise);
  std::abort();
}

inline std::string textOf(const std::uint8_t* data, std::size_t size) {
  return std::string(reinterpret_cast<const char*>(data), size);
}

/// Takes numbers from the front of an input; zeros once it is used up, so that every input means something.
class Bytes {
 public:
  Bytes(const std::uint8_t* data, std::size_t size) : data_(data), left_(size) {}

  template <typename Number>
  Number take() {
    Number number{};
    const std::size_t count = std::min(sizeof number, left_);
    if (count > 0) std::memcpy(&number, data_, count);
    data_ += count;
    left_ -= count;
    return number;
  }
  std::size_t left() const { return left_; }

 private:
  const std::uint8_t* data_;
  std::size_t left_;
};

/// A file that holds one input after another, in a directory that nobody else can write to; both are removed at the end.
class InputFile {
 public:
  /// @return path of a file named `name` with this content.
  const std::string& hold(const std::string& name, std::string_view content) {
    path_ = directory_.write(name, std::string(content));
    return path_;
  }

 private:
  TemporaryDirectory directory_;
  std::string path_;
};

}  // namespace tissue_contact::fuzz
