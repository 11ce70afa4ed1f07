#include "scene/yaml_reader.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <optional>
#include <stdexcept>

#include "tissue_contact/core/nearest_word.h"
#include "tissue_contact/core/text.h"

namespace tissue_contact {
namespace {

constexpr std::size_t kMaxTextBytes = 4096;

int lineOf(const YAML::Node& node, int otherwise) {
  const YAML::Mark mark = node.Mark();
  if (!mark.is_null()) return mark.line + 1;
  // Made anew by withSettings(): as a map, it stands where its first key does.
  const bool has_key = node.IsMap() && node.size() > 0 && !node.begin()->first.Mark().is_null();
  return has_key ? node.begin()->first.Mark().line + 1 : otherwise;
}

std::string typeName(const YAML::Node& node) {
  if (node.IsMap()) return "a map";
  if (node.IsSequence()) return "a list";
  if (node.IsNull()) return "empty";
  return inQuotes(node.Scalar());
}

/// An explicit type (a quoted text or a !!tag) is never taken for a number or a switch.
bool isPlain(const YAML::Node& node) { return node.Tag().empty() || node.Tag() == "?"; }

}  // namespace

YamlCursor::YamlCursor(const YAML::Node& node, std::string file, std::string path, int line,
                       std::shared_ptr<const SetPlaces> set)
    : node_(node), file_(std::move(file)), path_(std::move(path)), line_(line), set_(std::move(set)) {}

const SetPlaces& YamlCursor::set() const {
  static const SetPlaces none;
  return set_ == nullptr ? none : *set_;
}

void YamlCursor::fail(const std::string& problem) const {
  const std::string* setting = settingOf(set(), path_);
  const std::string place = setting != nullptr ? *setting : file_ + ":" + std::to_string(line_) + withSettings(set());
  throw std::invalid_argument(place + ": " + (path_.empty() ? "scene" : path_) + ": " + problem);
}

void YamlCursor::addLines(std::map<std::string, int>& lines) const {
  lines.emplace(path_, settingOf(set(), path_) != nullptr ? 0 : line_);
  if (node_.IsMap()) {
    for (const auto& entry : entries()) entry.second.addLines(lines);
  } else if (node_.IsSequence()) {
    for (const YamlCursor& value : list(0)) value.addLines(lines);
  }
}

YamlMap YamlCursor::map() const { return YamlMap(*this); }

std::vector<std::pair<std::string, YamlCursor>> YamlCursor::entries() const {
  if (!node_.IsMap()) fail("is " + typeName(node_) + "; it must be a map (key: value)");
  std::vector<std::pair<std::string, YamlCursor>> all;
  std::map<std::string, int> line_of_key;
  for (const auto& entry : node_) {
    const int line = lineOf(entry.first, line_);
    if (!entry.first.IsScalar() || entry.first.Scalar().empty()) {
      below(entry.first, path_, line).fail("has a key that is not text; every key must be plain text");
    }
    const std::string key = entry.first.Scalar();
    const std::string shown = inQuotes(key);
    const std::string name = shown.substr(1, shown.size() - 2);
    YamlCursor value = below(entry.second, path_.empty() ? name : path_ + "." + name, line);
    const auto [first, is_new] = line_of_key.emplace(key, line);
    if (!is_new) {
      value.fail("is given twice (first in line " + std::to_string(first->second) + "); remove one of them");
    }
    all.emplace_back(key, std::move(value));
  }
  return all;
}

YamlCursor YamlCursor::element(const YAML::Node& node, std::size_t index) const {
  // yaml-cpp places an empty element where the next token stands, which may be lines below.
  const int line = node.IsNull() ? line_ : lineOf(node, line_);
  return below(node, path_ + "[" + std::to_string(index) + "]", line);
}

std::vector<YamlCursor> YamlCursor::list(std::size_t minimum, std::size_t maximum) const {
  if (!node_.IsSequence()) fail("is " + typeName(node_) + "; it must be a list");
  if (node_.size() < minimum) {
    fail("has " + std::to_string(node_.size()) + " elements; it must have at least " + std::to_string(minimum));
  }
  if (node_.size() > maximum) {
    fail("has " + std::to_string(node_.size()) + " elements; at most " + std::to_string(maximum) + " are allowed");
  }
  std::vector<YamlCursor> all;
  for (const auto& node : node_) all.push_back(element(node, all.size()));
  return all;
}

std::vector<YamlCursor> YamlCursor::tuple(std::size_t length, const std::string& elements) const {
  const std::string wanted = "it must be a list of " + std::to_string(length) + " " + elements;
  if (!node_.IsSequence()) fail("is " + typeName(node_) + "; " + wanted);
  if (node_.size() != length) fail("has " + std::to_string(node_.size()) + " elements; " + wanted);
  return list(length);
}

std::string YamlCursor::scalar(const std::string& wanted) const {
  if (!node_.IsScalar()) fail("is " + typeName(node_) + "; it must be " + wanted);
  return node_.Scalar();
}

double YamlCursor::number(const Range& range) const {
  const std::string wanted = "a number " + range.text();
  const std::string fix = *range.fix != '\0' ? std::string("; ") + range.fix : "";
  const std::string value = scalar(wanted);
  if (!isPlain(node_)) fail("is the text " + inQuotes(value) + "; it must be " + wanted + " without quotes or tags");
  const std::optional<double> parsed = toDouble(value);
  if (!parsed || !range.contains(*parsed)) fail("is " + inQuotes(value) + "; it must be " + wanted + fix);
  return *parsed;
}

int YamlCursor::integer(int low, int high) const {
  const double value = number({static_cast<double>(low), static_cast<double>(high)});
  if (value != std::floor(value)) {
    fail("is " + inQuotes(node_.Scalar()) + "; it must be a whole number >= " + std::to_string(low) +
         " and <= " + std::to_string(high));
  }
  return static_cast<int>(value);
}

Vector3 YamlCursor::vector3(const Range& range) const {
  const std::vector<YamlCursor> components = tuple(3);
  return {components[0].number(range), components[1].number(range), components[2].number(range)};
}

bool YamlCursor::boolean() const {
  const std::string value = scalar("true or false");
  if (!isPlain(node_) || (value != "true" && value != "false")) {
    fail("is " + inQuotes(value) + "; it must be true or false");
  }
  return value == "true";
}

std::string YamlCursor::text() const {
  std::string value = scalar("text");
  if (value.empty()) fail("is empty; it must be text");
  if (value.size() > kMaxTextBytes) {
    fail("has " + std::to_string(value.size()) + " bytes; at most " + std::to_string(kMaxTextBytes) + " are allowed");
  }
  if (std::any_of(value.begin(), value.end(), isControl)) {
    fail("is " + inQuotes(value) + "; it must not hold control characters or line breaks");
  }
  return value;
}

std::size_t YamlCursor::indexOfWord(const std::vector<std::string>& allowed) const {
  const std::string word = text();
  const auto found = std::find(allowed.begin(), allowed.end(), word);
  if (found == allowed.end()) {
    fail("is " + inQuotes(word) + "; " + suggestion(word, allowed) + "allowed here: " + joined(allowed));
  }
  return static_cast<std::size_t>(found - allowed.begin());
}

YamlMap::YamlMap(const YamlCursor& cursor) : cursor_(cursor), entries_(cursor.entries()) {
  const std::vector<std::string>& keys = keysAt(cursor.path());
  for (const auto& [key, value] : entries_) {
    if (std::find(keys.begin(), keys.end(), key) != keys.end()) continue;
    value.fail("unknown key; " + suggestion(key, keys) + "allowed here: " + joined(keys));
  }
}

const YamlCursor* YamlMap::find(const std::string& key) const {
  for (const auto& entry : entries_) {
    if (entry.first == key) return &entry.second;
  }
  return nullptr;
}

const YamlCursor& YamlMap::get(const std::string& key) const {
  const YamlCursor* found = find(key);
  if (found == nullptr) cursor_.fail("required key " + inQuotes(key) + " is missing; add it");
  return *found;
}

void YamlMap::atMostOne(const std::vector<std::string>& keys) const {
  std::string first;
  for (const std::string& key : keys) {
    const YamlCursor* found = find(key);
    if (found != nullptr && !first.empty()) {
      found->fail("cannot be given together with " + inQuotes(first) + "; give at most one of " + joined(keys));
    }
    if (found != nullptr) first = key;
  }
}

std::string YamlMap::exactlyOne(const std::vector<std::string>& keys) const {
  atMostOne(keys);
  for (const std::string& key : keys) {
    if (find(key) != nullptr) return key;
  }
  cursor_.fail("none of " + joined(keys) + " is given; give exactly one of them");
}

}  // namespace tissue_contact
