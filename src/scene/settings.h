/// @file
/// Room `scene`, private: values set from outside the file ("--set KEY=VALUE"). A YAML tree and settings in; the tree as if the file said
/// so out, before anything is checked: a setting is refused with the words that the file would be refused with.
#pragma once

#include <yaml-cpp/yaml.h>

#include <map>
#include <string>
#include <vector>

namespace tissue_contact {

/// How often, and of how many bytes each.
constexpr std::size_t kMostSettings = 1000;
constexpr std::size_t kMaxSettingBytes = 4096;

/// The place "--set KEY=VALUE" of each entry that is not the file's, by path of keys: what was set, and the maps made for it.
using SetPlaces = std::map<std::string, std::string>;

/// The setting that an entry, or one around it, is from; null: the file.
const std::string* settingOf(const SetPlaces& set, const std::string& entry);

/// " (with --set KEY=VALUE)", all of them, for what is wrong in a file that they were set in; empty: none.
std::string withSettings(const SetPlaces& set);

/// Parses a text that must hold one YAML document. @param what_holds_it "<file>" in messages.
using ParseYamlText = YAML::Node (*)(const std::string& yaml, const std::string& what_holds_it);

/// The tree with all settings. The one given stays as it is: an alias stands for its anchor still wherever nothing is set.
/// @param settings "KEY=VALUE": KEY is a path of keys joined by '.', where an element of a list is told by its name or, as `[2]` or
///   `.2`, by its index; keys that hold a '.' are put in double quotes. VALUE is YAML.
/// @throws std::invalid_argument naming the setting, for no path, a list's element that is not there, and what would undo another setting.
YAML::Node withSettings(const YAML::Node& scene, const std::vector<std::string>& settings, ParseYamlText parse,
                        SetPlaces& places);

}  // namespace tissue_contact
