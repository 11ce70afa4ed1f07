#include "tissue_contact/core/command_line.h"

#include <algorithm>
#include <optional>
#include <stdexcept>

#include "tissue_contact/core/nearest_word.h"
#include "tissue_contact/core/text.h"

namespace tissue_contact {
namespace {

// A path must stay readable to its end.
constexpr std::size_t kMostShownBytes = 200;

bool contains(const std::vector<std::string>& all, const std::string& one) {
  return std::find(all.begin(), all.end(), one) != all.end();
}

[[noreturn]] void refuseUnknown(const std::string& argument, const std::string& key, const CommandLine::Keys& keys) {
  std::vector<std::string> known = keys.values;
  known.insert(known.end(), keys.repeatable.begin(), keys.repeatable.end());
  known.insert(known.end(), keys.switches.begin(), keys.switches.end());
  known.emplace_back("--help");
  throw std::invalid_argument("unknown argument '" + printable(argument, kMostShownBytes) + "'; " +
                              (key[0] == '-' ? suggestion(key, known) : "") + "known are " + joined(known));
}

[[noreturn]] void refuseValue(const std::string& key, const std::string& value, const std::string& must) {
  throw std::invalid_argument(key + " is '" + printable(value, kMostShownBytes) + "'; it must be " + must);
}

}  // namespace

CommandLine::CommandLine(const std::vector<std::string>& arguments, const Keys& keys) {
  for (std::size_t i = 0; i < arguments.size(); ++i) {
    const std::string& argument = arguments[i];
    if (argument == "--help" || argument == "-h") {
      help_ = true;
      return;
    }
    if (keys.words && (argument.empty() || argument[0] != '-' || argument == "-")) {
      words_.push_back(argument);
      continue;
    }
    const std::size_t equals = argument.find('=');
    const std::string key = argument.substr(0, equals);
    const bool in_next = equals == std::string::npos;
    const bool is_switch = contains(keys.switches, key);
    const bool is_repeatable = contains(keys.repeatable, key);
    if (!is_switch && !is_repeatable && !contains(keys.values, key)) refuseUnknown(argument, key, keys);
    if (is_switch && !in_next) throw std::invalid_argument("argument " + key + " takes no value");
    if (has(key) && !is_repeatable) throw std::invalid_argument("argument " + key + " is given twice");
    std::string value;
    if (!in_next) value = argument.substr(equals + 1);
    if (in_next && !is_switch && i + 1 < arguments.size() && arguments[i + 1].rfind("--", 0) != 0) {
      value = arguments[++i];
    }
    if (!is_switch && value.empty()) throw std::invalid_argument("argument " + key + " needs a value");
    given_[key].push_back(value);
  }
}

std::string CommandLine::value(const std::string& key) const { return has(key) ? given_.at(key).front() : ""; }

std::vector<std::string> CommandLine::all(const std::string& key) const {
  return has(key) ? given_.at(key) : std::vector<std::string>();
}

std::string CommandLine::required(const std::string& key) const {
  if (!has(key)) throw std::invalid_argument("argument " + key + " is missing; see --help");
  return value(key);
}

double CommandLine::number(const std::string& key, double otherwise, const Range& range) const {
  if (!has(key)) return otherwise;
  const std::optional<double> number = toDouble(value(key));
  if (!number || !range.contains(*number)) refuseValue(key, value(key), "a number " + range.text());
  return *number;
}

std::int64_t CommandLine::integer(const std::string& key, std::int64_t otherwise, std::int64_t low,
                                  std::int64_t high) const {
  if (!has(key)) return otherwise;
  const std::optional<std::int64_t> number = toInteger(value(key));
  if (!number || *number < low || *number > high) {
    refuseValue(key, value(key), "a whole number from " + std::to_string(low) + " to " + std::to_string(high));
  }
  return *number;
}

}  // namespace tissue_contact
