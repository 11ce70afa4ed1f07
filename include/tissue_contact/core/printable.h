/// @file
/// Room `core`: names from outside, as a line of a log can bear them: neither megabytes nor control characters.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

namespace tissue_contact {

/// The first `most` bytes of `name`, "..." where there are more; '?' for every control character.
std::string printable(const std::string& name, std::size_t most = 60);

/// "a, b, ...": the first `most` of them, printable.
std::string listOf(const std::vector<std::string>& names, std::size_t most = 12);

}  // namespace tissue_contact
