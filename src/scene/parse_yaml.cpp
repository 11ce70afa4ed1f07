#include <yaml-cpp/depthguard.h>

#include <stdexcept>

#include "yaml_reader.h"

namespace tissue_contact {
namespace {

constexpr int kMaxDepth = 32;       // the deepest place of a scene is 10 levels down
constexpr int kMaxValues = 100000;  // a big scene has some thousand

/// Walks the tree as the loader will, following each use of an alias: a small file of aliases of aliases may unfold
/// into billions of values, and an alias inside its own anchor never ends.
void checkSize(const YAML::Node& node, int depth, int& values_left, const YamlCursor& place) {
  if (depth > kMaxDepth) {
    place.fail("is nested more than " + std::to_string(kMaxDepth) + " levels deep or holds an alias of itself");
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

std::vector<YAML::Node> parseDocuments(const std::string& yaml, const std::string& file) {
  try {
    return YAML::LoadAll(yaml);
  } catch (const YAML::DeepRecursion& error) {
    throw std::invalid_argument(file + ":" + std::to_string(error.mark.line + 1) +
                                ": (YAML syntax): lists or maps are nested too deeply; at most " +
                                std::to_string(kMaxDepth) + " levels are allowed");
  } catch (const YAML::Exception& error) {
    throw std::invalid_argument(file + ":" + std::to_string(error.mark.line + 1) + ": (YAML syntax): " + error.msg +
                                " (column " + std::to_string(error.mark.column + 1) +
                                "); check indentation, colons, brackets and quotes near this line");
  }
}

}  // namespace

YamlCursor parseYaml(const std::string& yaml, const std::string& file) {
  const std::string name = file.empty() ? "(scene text)" : file;
  if (yaml.size() > kMaxSceneBytes) {
    throw std::invalid_argument(name + ":1: scene: has " + std::to_string(yaml.size()) + " bytes; at most " +
                                std::to_string(kMaxSceneBytes) + " are allowed");
  }
  const std::vector<YAML::Node> documents = parseDocuments(yaml, name);
  if (documents.empty() || documents.front().IsNull()) {
    throw std::invalid_argument(name + ":1: scene: is empty; it must have at least the key \"tissues\"");
  }
  const int line = documents.front().Mark().is_null() ? 1 : documents.front().Mark().line + 1;
  YamlCursor root(documents.front(), name, "", line);
  if (documents.size() > 1) {
    root.fail("the file holds " + std::to_string(documents.size()) + " YAML documents; remove the extra \"---\"");
  }
  int values_left = kMaxValues;
  checkSize(documents.front(), 0, values_left, root);
  return root;
}

}  // namespace tissue_contact
