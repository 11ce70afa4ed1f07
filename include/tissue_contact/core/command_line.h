/// @file
/// Room `core`: the command lines of all tools. Words in, values by key out; what is not understood is refused.
#pragma once

#include <cstdint>
#include <map>
#include <string>
#include <vector>

#include "tissue_contact/core/range.h"

namespace tissue_contact {

/// `--key value` and `--key=value` are the same. A value that begins with "--" needs the second form: after a forgotten
/// value the next key is not taken for one. Not Boost.Program_options or CLI11: neither names the nearest known key nor the
/// range of a number, and the first takes every beginning of a key for it.
class CommandLine {
 public:
  /// What a tool knows. --help and -h are known everywhere.
  struct Keys {
    std::vector<std::string> values;      ///< with a value, once
    std::vector<std::string> switches;    ///< without, once
    std::vector<std::string> repeatable;  ///< with a value, any number of times
    bool words = false;                   ///< arguments without a key are allowed too
  };

  /// @param arguments without the program's name. What follows --help is not looked at.
  /// @throws std::invalid_argument naming the argument that is unknown (and the nearest known one), given twice or without
  ///   its value.
  CommandLine(const std::vector<std::string>& arguments, const Keys& keys);

  bool help() const { return help_; }
  bool has(const std::string& key) const { return given_.count(key) > 0; }

  /// Empty when the key is not given.
  std::string value(const std::string& key) const;
  std::vector<std::string> all(const std::string& key) const;
  const std::vector<std::string>& words() const { return words_; }

  /// @throws std::invalid_argument when the key is not given.
  std::string required(const std::string& key) const;

  /// `otherwise` when the key is not given.
  /// @throws std::invalid_argument naming key, value and range.
  double number(const std::string& key, double otherwise, const Range& range) const;
  std::int64_t integer(const std::string& key, std::int64_t otherwise, std::int64_t low, std::int64_t high) const;

 private:
  std::map<std::string, std::vector<std::string>> given_;
  std::vector<std::string> words_;
  bool help_ = false;
};

}  // namespace tissue_contact
