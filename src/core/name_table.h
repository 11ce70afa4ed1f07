/// @file
/// Room `core`: the words that stand for the values of an enumeration in files and on command lines.
#pragma once

#include <cstddef>
#include <stdexcept>
#include <string>
#include <utility>

namespace tissue_contact {

/// @param what names the enumeration in messages.
/// @throws std::invalid_argument for a value that is not in the table.
template <typename Value, std::size_t kCount>
const char* nameOf(Value value, const std::pair<const char*, Value> (&table)[kCount], const char* what) {
  for (const auto& [name, named] : table) {
    if (named == value) return name;
  }
  throw std::invalid_argument(std::string(what) + " number " + std::to_string(static_cast<int>(value)) +
                              " does not exist; use a named one");
}

/// @throws std::invalid_argument naming the words there are.
template <typename Value, std::size_t kCount>
Value valueOf(const std::string& word, const std::pair<const char*, Value> (&table)[kCount], const char* what) {
  std::string known;
  for (const auto& [name, named] : table) {
    if (name == word) return named;
    known += (known.empty() ? "" : ", ") + std::string(name);
  }
  throw std::invalid_argument("unknown " + std::string(what) + " \"" + word + "\"; it must be one of " + known);
}

}  // namespace tissue_contact
