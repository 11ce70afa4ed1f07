/// doc/scene.md against the loader: every key in its table, no key that does not exist, an example that uses them all.
#include <map>
#include <set>
#include <sstream>

#include "scene_fixture.h"
#include "tissue_contact/core/read_file.h"

namespace tissue_contact {
namespace scene_doc_test {

std::string documentText() {
  return readFile(TISSUE_CONTACT_SOURCE_DIR "/doc/scene.md", "document", std::uintmax_t{1} << 20U);
}

/// Keys in the table of each section "### `path`".
std::map<std::string, std::set<std::string>> documentedKeys() {
  std::map<std::string, std::set<std::string>> keys;
  std::istringstream text(documentText());
  std::string section;
  for (std::string line; std::getline(text, line);) {
    const auto between = [&line](std::size_t begin) { return line.substr(begin, line.find('`', begin) - begin); };
    if (line.compare(0, 5, "### `") == 0) section = between(5);
    if (line.compare(0, 3, "| `") == 0 && !keys[section].insert(between(3)).second) {
      ADD_FAILURE() << section << ": " << between(3) << " is documented twice";
    }
  }
  return keys;
}

std::string example() {
  const std::string text = documentText();
  const std::string fence = "```yaml\n";
  const std::size_t begin = text.find(fence);
  if (begin == std::string::npos) return "";
  return text.substr(begin + fence.size(), text.find("```\n", begin + 1) - begin - fence.size());
}

TEST(SceneDocument, HasExactlyTheKeysOfTheLoader) {
  std::map<std::string, std::set<std::string>> known;
  for (const auto& [path, keys] : sceneKeys()) known[path] = {keys.begin(), keys.end()};
  const auto documented = documentedKeys();
  for (const auto& [path, keys] : known) {
    const auto section = documented.find(path);
    ASSERT_NE(section, documented.end()) << "no section for " << path;
    EXPECT_EQ(section->second, keys) << path;
  }
  EXPECT_EQ(documented.size(), known.size());
}

TEST_F(SceneTest, ExampleOfTheDocumentLoadsAndUsesEveryKey) {
  for (const char* directory : {"meshes", "urdf"}) std::filesystem::create_directory(path(directory));
  for (const char* file : {"meshes/liver.vtk", "meshes/kidney.stl", "meshes/phantom.vtk", "meshes/cover.stl",
                           "meshes/gut.obj", "urdf/psm_classic.urdf"})
    write(file, "x");
  const std::string yaml = example();
  const Scene scene = parse(yaml);
  EXPECT_EQ(scene.tissues.size(), 6U);
  EXPECT_EQ(scene.instruments.size(), 2U);
  for (const auto& [path, keys] : sceneKeys()) {
    for (const std::string& key : keys) EXPECT_NE(yaml.find(key + ":"), std::string::npos) << path << "." << key;
  }
}

}  // namespace scene_doc_test
}  // namespace tissue_contact
