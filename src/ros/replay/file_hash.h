/// @file
/// Room `ros/replay`, private: what a file holds, as 64 hexadecimal digits that no other content has (SHA-256, as sha256sum prints them).
#pragma once

#include <cstdint>
#include <string>

namespace tissue_contact {

struct FileHash {
  std::uintmax_t bytes = 0;
  std::string sha256;
};

/// @param what names the file's kind in messages.
/// @throws std::invalid_argument for what is no regular file, or cannot be read.
FileHash hashOfFile(const std::string& file, const std::string& what);

}  // namespace tissue_contact
