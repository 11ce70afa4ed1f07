#include "scene/settings.h"

#include <algorithm>
#include <array>
#include <optional>
#include <stdexcept>
#include <utility>

#include "scene/yaml_reader.h"
#include "tissue_contact/core/nearest_word.h"
#include "tissue_contact/core/text.h"

namespace tissue_contact {
namespace {

constexpr std::size_t kMaxParts = 32;  // the deepest key of a scene has 10
constexpr std::size_t kShownBytes = 200;

/// Entries that a word may stand for, and the key of the map it is short for; "": a word that says there is no map.
constexpr std::array<std::pair<const char*, const char*>, 6> kShortFor = {{
    {"tissues[].material", "preset"},
    {"tissues[].regions[].material", "preset"},
    {"instruments[].contact_links[]", "link"},
    {"instruments[].joint_state_topics[]", "topic"},
    {"tissues[].refinement", ""},
    {"friction[].axis", ""},
}};

/// What an element of a list goes by: its "name", or else its "link", or itself where it is a word. Empty: nothing.
std::string nameOf(const YAML::Node& element) {
  if (element.IsScalar()) return element.Scalar();
  if (!element.IsMap()) return "";
  for (const char* key : {"name", "link"}) {
    const YAML::Node name = element[key];
    if (name.IsDefined() && name.IsScalar()) return name.Scalar();
  }
  return "";
}

class Setting {
 public:
  Setting(const std::string& text, ParseYamlText parse, SetPlaces& places)
      : place_("--set " + printable(text, kShownBytes)), places_(places) {
    if (text.size() > kMaxSettingBytes) {
      fail("has " + std::to_string(text.size()) + " bytes; at most " + std::to_string(kMaxSettingBytes) +
           " are allowed");
    }
    const std::size_t end = readKey(text);
    if (end == text.size()) fail("has no \"=\"; write KEY=VALUE, such as step.max_step_s=0.002");
    value_ = parse(text.substr(end + 1), place_);
  }

  YAML::Node in(const YAML::Node& scene) { return replaced(scene, 0, ""); }

 private:
  [[noreturn]] void fail(const std::string& problem) const { throw std::invalid_argument(place_ + ": " + problem); }

  /// @return where the key ends.
  std::size_t readKey(const std::string& text) {
    std::size_t i = 0;
    while (true) {
      const bool is_quoted = text[i] == '"';
      const std::size_t begin = i + static_cast<std::size_t>(is_quoted);
      i = std::min(text.find_first_of(is_quoted ? "\"" : ".[]=\"", begin), text.size());
      if (is_quoted && i == text.size()) fail("has no closing quote in its key");
      addPart(text.substr(begin, i - begin));
      i += static_cast<std::size_t>(is_quoted);
      while (i < text.size() && text[i] == '[') {
        const std::size_t close = std::min(text.find(']', i), text.size());
        addPart(text.substr(i + 1, close - i - 1));
        i = std::min(close + 1, text.size());
      }
      if (i == text.size() || text[i] == '=') return i;
      if (text[i] != '.') fail("is no path of keys; write it as tissues.block.material.youngs_modulus_pa=4000");
      ++i;
    }
  }

  void addPart(const std::string& part) {
    if (part.empty()) fail("has an empty part in its key; write it as tissues.block.material.youngs_modulus_pa=4000");
    parts_.push_back(part);
    if (parts_.size() > kMaxParts) fail("has a key of more than " + std::to_string(kMaxParts) + " parts");
  }

  /// The node with the value at the path that parts_[at] and those behind it are.
  YAML::Node replaced(const YAML::Node& node, std::size_t at, const std::string& path) {
    if (at == parts_.size()) {
      notePlace(path);
      return value_;
    }
    if (node.IsSequence()) return replacedInList(node, at, path);
    if (node.IsMap() || !node.IsDefined() || node.IsNull()) return replacedInMap(node, at, path);
    for (const auto& [kind, key] : kShortFor) {
      if (tablePath(path) != kind) continue;
      YAML::Node map(YAML::NodeType::Map);
      if (*key != '\0') map.force_insert(std::string(key), node);
      return replacedInMap(map, at, path);
    }
    fail(path + " is " + inQuotes(node.Scalar()) + "; it has no " + inQuotes(parts_[at]));
  }

  YAML::Node replacedInMap(const YAML::Node& node, std::size_t at, const std::string& path) {
    const std::string shown = inQuotes(parts_[at]);  // as YamlCursor names it
    const std::string below = (path.empty() ? "" : path + ".") + shown.substr(1, shown.size() - 2);
    YAML::Node map(YAML::NodeType::Map);
    bool is_there = false;
    for (const auto& entry : node) {
      const bool is_it = !is_there && entry.first.IsScalar() && entry.first.Scalar() == parts_[at];
      map.force_insert(entry.first, is_it ? replaced(entry.second, at + 1, below) : entry.second);
      is_there |= is_it;
    }
    if (is_there) return map;
    map.force_insert(parts_[at], replaced(YAML::Node(), at + 1, below));
    places_.emplace(below, place_);
    return map;
  }

  YAML::Node replacedInList(const YAML::Node& node, std::size_t at, const std::string& path) {
    const std::size_t index = indexIn(node, parts_[at], path);
    YAML::Node list(YAML::NodeType::Sequence);
    for (std::size_t i = 0; i < node.size(); ++i) {
      list.push_back(i == index ? replaced(node[i], at + 1, path + "[" + std::to_string(i) + "]") : node[i]);
    }
    return list;
  }

  std::size_t indexIn(const YAML::Node& list, const std::string& part, const std::string& path) const {
    const std::optional<std::int64_t> index = toInteger(part);
    if (index && *index >= 0 && *index < static_cast<std::int64_t>(list.size())) {
      return static_cast<std::size_t>(*index);
    }
    std::vector<std::string> names;
    std::vector<std::size_t> found;
    for (std::size_t i = 0; i < list.size(); ++i) {
      const std::string name = nameOf(list[i]);
      if (name == part) found.push_back(i);
      if (!name.empty()) names.push_back(name);
    }
    if (found.size() == 1) return found.front();
    if (found.size() > 1) {
      fail(path + " has several elements " + inQuotes(part) + "; give the index: " + std::to_string(found[0]) + " or " +
           std::to_string(found[1]));
    }
    fail(path + " has no element " + inQuotes(part) + "; " + suggestion(part, names) +
         (names.empty() ? "" : "there are " + listOf(names) + "; ") + "its length is " + std::to_string(list.size()) +
         ", indices begin with 0");
  }

  /// Refuses what would undo an earlier setting, whose author would not see why it does nothing.
  void notePlace(const std::string& path) {
    for (auto set = places_.lower_bound(path); set != places_.end() && set->first.rfind(path, 0) == 0; ++set) {
      const char next = set->first.size() == path.size() ? '\0' : set->first[path.size()];
      if (next == '\0' || next == '.' || next == '[') {
        fail("would undo " + set->second + "; leave one of them out, or give this one first");
      }
    }
    places_.emplace(path, place_);
  }

  std::string place_;
  SetPlaces& places_;
  std::vector<std::string> parts_;
  YAML::Node value_;
};

}  // namespace

const std::string* settingOf(const SetPlaces& set, const std::string& entry) {
  std::string around = set.empty() ? "" : entry;
  while (!around.empty()) {
    if (const auto found = set.find(around); found != set.end()) return &found->second;
    const std::size_t end = around.find_last_of(".[");
    around.resize(end == std::string::npos ? 0 : end);
  }
  return nullptr;
}

std::string withSettings(const SetPlaces& set) {
  if (set.empty()) return "";
  std::vector<std::string> all;
  for (const auto& [path, place] : set) {
    if (std::find(all.begin(), all.end(), place) == all.end()) all.push_back(place);
  }
  return " (with " + listOf(all) + ")";
}

YAML::Node withSettings(const YAML::Node& scene, const std::vector<std::string>& settings, ParseYamlText parse,
                        SetPlaces& places) {
  if (settings.size() > kMostSettings) {
    throw std::invalid_argument("--set is given " + std::to_string(settings.size()) + " times; at most " +
                                std::to_string(kMostSettings) + " are allowed");
  }
  YAML::Node changed;
  changed.reset(scene);
  for (const std::string& setting : settings) changed.reset(Setting(setting, parse, places).in(changed));
  return changed;
}

}  // namespace tissue_contact
