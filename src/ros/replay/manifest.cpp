#include "ros/replay/manifest.h"

#include <dlfcn.h>
#include <yaml-cpp/yaml.h>

#include <filesystem>
#include <map>

#include "ros/absolute_path.h"
#include "ros/replay/commit.h"  // made by CMakeLists.txt
#include "ros/replay/file_hash.h"
#include "tissue_contact/scene/load_scene.h"
#include "tissue_contact/version.h"

namespace tissue_contact {
namespace {

/// The file that the code at an address was loaded from.
std::string loadedFrom(const void* address) {
  Dl_info info{};
  return dladdr(address, &info) != 0 && info.dli_fname != nullptr ? info.dli_fname : "";
}

std::vector<NamedFile> programFiles() {
  std::vector<NamedFile> files = {{"program", std::filesystem::read_symlink("/proc/self/exe").string()}};
  const std::string ros = loadedFrom(reinterpret_cast<const void*>(&writeManifest));
  const std::string core = loadedFrom(reinterpret_cast<const void*>(&sceneKeys));
  for (const std::string& library : {ros, core}) {
    if (!library.empty()) files.push_back({"library", library});
  }
  return files;
}

/// @param content where the bytes are now.
void addFile(YAML::Emitter& yaml, const NamedFile& file, const std::string& content) {
  const FileHash hash = hashOfFile(content, file.role);
  yaml << YAML::BeginMap << YAML::Key << "role" << YAML::Value << YAML::DoubleQuoted << file.role << YAML::Key << "file"
       << YAML::Value << YAML::DoubleQuoted << absolutePath(file.path) << YAML::Key << "bytes" << YAML::Value
       << hash.bytes << YAML::Key << "sha256" << YAML::Value << YAML::DoubleQuoted << hash.sha256 << YAML::EndMap;
}

void addFiles(YAML::Emitter& yaml, const char* key, const std::vector<NamedFile>& files) {
  yaml << YAML::Key << key << YAML::Value << YAML::BeginSeq;
  std::map<std::string, bool> seen;
  for (const NamedFile& file : files) {
    const bool is_new = !file.path.empty() && seen.emplace(absolutePath(file.path), true).second;
    if (is_new) addFile(yaml, file, file.path);
  }
  yaml << YAML::EndSeq;
}

void addTexts(YAML::Emitter& yaml, const char* key, const std::vector<std::string>& texts) {
  yaml << YAML::Key << key << YAML::Value << YAML::BeginSeq;
  for (const std::string& text : texts) yaml << YAML::DoubleQuoted << text;
  yaml << YAML::EndSeq;
}

void addVersions(YAML::Emitter& yaml, const std::string& gmsh) {
  yaml << YAML::Key << "versions" << YAML::Value << YAML::BeginMap;
  const std::pair<const char*, const char*> versions[] = {{"tissue_contact", TISSUE_CONTACT_VERSION},
                                                          {"git", TISSUE_CONTACT_COMMIT},
                                                          {"compiler", TISSUE_CONTACT_COMPILER},
                                                          {"assimp", TISSUE_CONTACT_ASSIMP},
                                                          {"eigen", TISSUE_CONTACT_EIGEN},
                                                          {"fcl", TISSUE_CONTACT_FCL},
                                                          {"roscpp", TISSUE_CONTACT_ROSCPP},
                                                          {"urdfdom", TISSUE_CONTACT_URDFDOM},
                                                          {"yaml-cpp", TISSUE_CONTACT_YAML_CPP}};
  for (const auto& [name, version] : versions) {
    yaml << YAML::Key << name << YAML::Value << YAML::DoubleQuoted << (*version == '\0' ? "unknown" : version);
  }
  if (!gmsh.empty()) yaml << YAML::Key << "gmsh" << YAML::Value << YAML::DoubleQuoted << gmsh;
  yaml << YAML::EndMap;
}

}  // namespace

void writeManifest(std::ostream& out, const ReplayOptions& options, const ManifestContent& content) {
  YAML::Emitter yaml(out);
  yaml << YAML::BeginMap << YAML::Key << "manifest" << YAML::Value << "tissue_contact_replay 1";
  addTexts(yaml, "arguments", options.arguments);
  addTexts(yaml, "set", options.settings);
  addVersions(yaml, content.gmsh);
  addFiles(yaml, "program", programFiles());
  addFiles(yaml, "inputs", content.inputs);
  yaml << YAML::Key << "counts" << YAML::Value << YAML::BeginMap;
  for (const auto& [name, count] : content.counts) yaml << YAML::Key << name << YAML::Value << count;
  yaml << YAML::EndMap << YAML::Key << "results" << YAML::Value << YAML::BeginSeq;
  for (const auto& result : content.results) addFile(yaml, {result.role, result.place}, result.content);
  yaml << YAML::EndSeq << YAML::EndMap;
  out << '\n';
}

}  // namespace tissue_contact
