/// @file
/// Room `core`: reading files without hanging on a pipe or filling the memory.
#pragma once

#include <cstdint>
#include <limits>
#include <string>

namespace tissue_contact {

/// Refuses what is not a readable regular file with 1 to `max_bytes` bytes: a FIFO would block, a device may never end.
/// Symbolic links are followed.
/// @param what names the file's kind in messages.
/// @throws std::invalid_argument naming the file, what it is instead, and for stand-ins (git-lfs, git-annex) the
///   remedy.
void requireRegularFile(const std::string& file, const std::string& what,
                        std::uintmax_t max_bytes = std::numeric_limits<std::uintmax_t>::max());

/// Whole content of such a file; never takes memory for more than `max_bytes`, also when the file grows meanwhile.
/// @throws as requireRegularFile, and when reading fails.
std::string readFile(const std::string& file, const std::string& what, std::uintmax_t max_bytes);

/// "a directory", "a FIFO (named pipe)", ... for the type bits of a stat mode; empty for a regular file.
std::string fileTypeName(unsigned mode);

}  // namespace tissue_contact
