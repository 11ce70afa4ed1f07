/// @file
/// Room `scene`, private: YAML text in, values with checked type and range out. Every check is made here once, and
/// every failure is a std::invalid_argument "<file>:<line>: <key path>: <problem, allowed range, fix>".
#pragma once

#include <yaml-cpp/yaml.h>

#include <limits>
#include <map>
#include <memory>
#include <string>
#include <utility>
#include <vector>

#include "scene/settings.h"
#include "tissue_contact/core/range.h"
#include "tissue_contact/core/types.h"

namespace tissue_contact {

class YamlMap;

/// Allowed keys of the map at a path such as "tissues[0].material"; "" is the whole file.
/// @throws std::out_of_range where there is no map, or one with free keys (joint names).
const std::vector<std::string>& keysAt(const std::string& path);
/// By which sceneKeys() has the map at a path: "tissues[].material".
std::string tablePath(const std::string& path);

/// One value of the file with the place it stands at. Cheap to copy; the yaml-cpp tree is shared.
class YamlCursor {
 public:
  /// @param path key path such as "tissues[0].name".
  /// @param line counted from 1.
  /// @param set what is not the file's; null: nothing.
  YamlCursor(const YAML::Node& node, std::string file, std::string path, int line,
             std::shared_ptr<const SetPlaces> set = nullptr);

  [[noreturn]] void fail(const std::string& problem) const;

  const std::string& path() const { return path_; }
  int line() const { return line_; }
  bool isScalar() const { return node_.IsScalar(); }

  /// What is not the file's.
  const SetPlaces& set() const;
  /// Adds the lines of this value and of all below it, by key path.
  void addLines(std::map<std::string, int>& lines) const;

  /// Fails unless it is a map with keysAt() its path alone.
  YamlMap map() const;
  /// Entries of a map with free keys, in file order; keys given twice are refused.
  std::vector<std::pair<std::string, YamlCursor>> entries() const;
  /// Elements of a list of `minimum` to `maximum` elements.
  std::vector<YamlCursor> list(std::size_t minimum,
                               std::size_t maximum = std::numeric_limits<std::size_t>::max()) const;
  /// Elements of a list of exactly `length` elements; `elements` says in messages what they are.
  std::vector<YamlCursor> tuple(std::size_t length, const std::string& elements = "numbers") const;

  /// Plain (unquoted) numbers. NaN and infinity are outside every range.
  double number(const Range& range) const;
  int integer(int low, int high) const;
  Vector3 vector3(const Range& range) const;
  bool boolean() const;
  /// Non-empty text of at most 4096 bytes without control characters.
  std::string text() const;
  /// The value that the word given here stands for.
  template <typename Value, std::size_t kCount>
  Value choice(const std::pair<const char*, Value> (&choices)[kCount]) const {
    std::vector<std::string> words;
    for (const auto& entry : choices) words.emplace_back(entry.first);
    return choices[indexOfWord(words)].second;
  }

 private:
  std::size_t indexOfWord(const std::vector<std::string>& allowed) const;
  std::string scalar(const std::string& wanted) const;
  YamlCursor element(const YAML::Node& node, std::size_t index) const;
  YamlCursor below(const YAML::Node& node, std::string path, int line) const {
    return {node, file_, std::move(path), line, set_};
  }

  YAML::Node node_;
  std::string file_;
  std::string path_;
  int line_;
  std::shared_ptr<const SetPlaces> set_;
};

/// A map whose keys have been checked.
class YamlMap {
 public:
  explicit YamlMap(const YamlCursor& cursor);

  const YamlCursor& cursor() const { return cursor_; }
  /// Null when the key is not given. The pointer lives as long as this map.
  const YamlCursor* find(const std::string& key) const;
  /// Fails when the key is not given.
  const YamlCursor& get(const std::string& key) const;
  /// The one key of `keys` that is given; fails when none or several are.
  std::string exactlyOne(const std::vector<std::string>& keys) const;
  /// Fails when more than one of `keys` is given.
  void atMostOne(const std::vector<std::string>& keys) const;

 private:
  YamlCursor cursor_;
  std::vector<std::pair<std::string, YamlCursor>> entries_;
};

/// Parses text that must hold exactly one document. Size, depth and the number of values (aliases counted wherever they
/// are used) are bounded, so that no file can exhaust time, stack or memory.
/// @param settings "KEY=VALUE", as if the text said so (see withSettings()).
YamlCursor parseYaml(const std::string& yaml, const std::string& file, const std::vector<std::string>& settings = {});

/// Bytes allowed in a scene file: a hundred times what a big scene needs.
constexpr std::size_t kMaxSceneBytes = 1U << 20U;

}  // namespace tissue_contact
