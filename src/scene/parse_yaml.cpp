#include <yaml-cpp/depthguard.h>
#include <yaml-cpp/eventhandler.h>

#include <algorithm>
#include <cstddef>
#include <functional>
#include <memory>
#include <sstream>
#include <stdexcept>

#include "scene/yaml_reader.h"

namespace tissue_contact {
namespace {

constexpr int kMaxYamlDepth = 32;   // the deepest place of a scene is 10 levels down
constexpr int kMaxValues = 100000;  // a big scene has some thousand

/// Walks the tree as the loader will, following each use of an alias: a small file of aliases of aliases may unfold
/// into billions of values, and an alias inside its own anchor never ends.
void checkSize(const YAML::Node& node, int depth, int& values_left, const YamlCursor& place) {
  if (depth > kMaxYamlDepth) {
    place.fail("is nested more than " + std::to_string(kMaxYamlDepth) + " levels deep or holds an alias of itself");
  }
  if (--values_left < 0) {
    place.fail("holds more than " + std::to_string(kMaxValues) +
               " values, aliases counted wherever they are used; split it into several scenes");
  }
  if (node.IsSequence()) {
    for (const auto& element : node) checkSize(element, depth + 1, values_left, place);
  } else if (node.IsMap()) {
    for (const auto& entry : node) {
      checkSize(entry.first, depth + 1, values_left, place);
      checkSize(entry.second, depth + 1, values_left, place);
    }
  }
}

/// Ends the parsing of a text that makes more values than are allowed, before any memory is taken for them.
class ValueCount : public YAML::EventHandler {
 public:
  void OnDocumentStart(const YAML::Mark& mark) override { ++documents_, count(mark); }
  void OnDocumentEnd() override {}
  void OnNull(const YAML::Mark& mark, YAML::anchor_t) override { count(mark); }
  void OnAlias(const YAML::Mark& mark, YAML::anchor_t) override { count(mark); }
  void OnScalar(const YAML::Mark& mark, const std::string&, YAML::anchor_t, const std::string&) override {
    count(mark);
  }
  void OnSequenceStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t, YAML::EmitterStyle::value) override {
    count(mark);
  }
  void OnSequenceEnd() override {}
  void OnMapStart(const YAML::Mark& mark, const std::string&, YAML::anchor_t, YAML::EmitterStyle::value) override {
    count(mark);
  }
  void OnMapEnd() override {}

 private:
  void count(const YAML::Mark& mark) {
    if (documents_ > 1) throw YAML::ParserException(mark, "a second YAML document begins; remove the extra \"---\"");
    if (++values_ > 2 * kMaxValues) {  // checkSize() names the place of fewer, which cost little memory
      throw YAML::ParserException(mark, "the text holds more than " + std::to_string(kMaxValues) + " values");
    }
  }

  int documents_ = 0;
  int values_ = 0;
};

/// Where a line stands, for messages.
using LinePlace = std::function<std::string(int line)>;

/// Within brackets yaml-cpp before 0.7 takes a colon right before "]" or the end of the text for an empty scalar, again and again until
/// memory ends (its issues 499 and 793); hence also the blank that ends what it is given. The byte 4 is its mark of the end, and
/// zeros make it read UTF-16, in which neither would be seen. Refused with every version, in comments and quotes too, so that a scene is the same scene everywhere.
void checkColons(const std::string& yaml, const LinePlace& place) {
  const std::size_t at = std::min({yaml.find(":]"), yaml.find('\x04'), yaml.find('\0')});
  if (at == std::string::npos) return;
  const auto line = std::count(yaml.begin(), yaml.begin() + static_cast<std::ptrdiff_t>(at), '\n');
  throw std::invalid_argument(place(static_cast<int>(line) + 1) + ": (YAML syntax): " +
                              (yaml[at] == ':' ? "\":]\" is not allowed; write a value or a blank after the colon"
                                               : "control characters are not allowed; save it as UTF-8 without them"));
}

/// The only document of the text; null if there is none.
/// YAML::LoadAll is not used: after a text such as ",|<" yaml-cpp 0.7 finds one more empty document for ever.
YAML::Node parseDocument(const std::string& yaml, const LinePlace& place) {
  try {
    ValueCount count;
    checkColons(yaml, place);
    const std::string ended = yaml + " ";
    std::istringstream text(ended);
    YAML::Parser parser(text);
    while (parser.HandleNextDocument(count)) {
    }
    return YAML::Load(ended);
  } catch (const YAML::DeepRecursion& error) {
    throw std::invalid_argument(place(error.mark.line + 1) +
                                ": (YAML syntax): lists or maps are nested too deeply; at most " +
                                std::to_string(kMaxYamlDepth) + " levels are allowed");
  } catch (const YAML::Exception& error) {
    throw std::invalid_argument(place(error.mark.line + 1) + ": (YAML syntax): " + error.msg + " (column " +
                                std::to_string(error.mark.column + 1) +
                                "); check indentation, colons, brackets and quotes near this line");
  }
}

YAML::Node parseSetting(const std::string& value, const std::string& place) {
  return parseDocument(value, [&place](int /*line*/) { return place; });
}

}  // namespace

YamlCursor parseYaml(const std::string& yaml, const std::string& file, const std::vector<std::string>& settings) {
  const std::string name = file.empty() ? "(scene text)" : file;
  if (yaml.size() > kMaxSceneBytes) {
    throw std::invalid_argument(name + ":1: scene: has " + std::to_string(yaml.size()) + " bytes; at most " +
                                std::to_string(kMaxSceneBytes) + " are allowed");
  }
  const YAML::Node document = parseDocument(yaml, [&name](int line) { return name + ":" + std::to_string(line); });
  if (document.IsNull()) {
    throw std::invalid_argument(name + ":1: scene: is empty; it must have at least the key \"tissues\"");
  }
  const int line = document.Mark().is_null() ? 1 : document.Mark().line + 1;
  const auto checked = [&](const YAML::Node& tree, std::shared_ptr<const SetPlaces> set) {
    YamlCursor root(tree, name, "", line, std::move(set));
    int values_left = kMaxValues;
    checkSize(tree, 0, values_left, root);
    return root;
  };
  YamlCursor root = checked(document, nullptr);
  if (settings.empty()) return root;
  const auto places = std::make_shared<SetPlaces>();
  const YAML::Node tree = withSettings(document, settings, parseSetting, *places);
  return checked(tree, places);
}

}  // namespace tissue_contact
