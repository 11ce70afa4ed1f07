/// @file
/// Test helper: texts spoilt in one place.
#pragma once

#include <stdexcept>
#include <string>

namespace tissue_contact {

/// `text` with its only occurrence of `from` replaced. @throws std::logic_error unless there is exactly one, so that no
/// test can run on the unchanged text, or on another change than it means.
inline std::string replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  if (at == std::string::npos || text.find(from, at + 1) != std::string::npos) {
    throw std::logic_error("\"" + from + "\" does not occur exactly once");
  }
  return text.replace(at, from.size(), to);
}

}  // namespace tissue_contact
