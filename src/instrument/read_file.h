/// @file
/// Room `instrument` (private): reading files without hanging on a pipe or filling the memory.
#pragma once

#include <cstdint>
#include <string>

namespace tissue_contact {

/// Refuses what is not a readable regular file of at most `max_bytes`. @param what names the file's kind in messages.
/// @throws std::invalid_argument naming the file.
void requireRegularFile(const std::string& file, const std::string& what, std::uintmax_t max_bytes);

/// Whole content of such a file. @throws as requireRegularFile, and when reading fails.
std::string readFile(const std::string& file, const std::string& what, std::uintmax_t max_bytes);

}  // namespace tissue_contact
