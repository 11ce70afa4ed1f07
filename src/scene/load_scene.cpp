#include "tissue_contact/scene/load_scene.h"

#include <filesystem>
#include <map>
#include <stdexcept>

#include "scene/read_more.h"
#include "scene/scene_ranges.h"
#include "scene/scene_sections.h"
#include "tissue_contact/core/entry_error.h"
#include "tissue_contact/core/read_file.h"
#include "tissue_contact/core/resolve_path.h"
#include "tissue_contact/core/text.h"
#include "tissue_contact/simulation/scene.h"

namespace tissue_contact {
namespace {

namespace fs = std::filesystem;

constexpr Range kGravityRange{-1000.0, 1000.0, "m/s^2"};
constexpr Range kMaxStepRange{1e-6, 1.0, "s", "give seconds: 1 ms is 0.001"};
constexpr Range kMaxGapRange{1e-6, 60.0, "s", "give seconds"};
constexpr std::pair<const char*, StatePolicy> kStatePolicies[] = {{"auto", StatePolicy::kAuto},
                                                                  {"every_state", StatePolicy::kEveryState},
                                                                  {"newest_state", StatePolicy::kNewestState}};

/// Where each name was first given. One set for tissues and instruments: both become topics of the same node.
using NameLines = std::map<std::string, int>;

void addName(const std::string& name, const YamlCursor& cursor, NameLines& lines) {
  const auto [first, is_new] = lines.emplace(name, cursor.line());
  if (!is_new) {
    cursor.fail("the name " + inQuotes(name) + " is already used (line " + std::to_string(first->second) +
                "); tissues and instruments need different names");
  }
}

StepDescription parseStep(const YamlCursor& cursor) {
  const YamlMap map = cursor.map();
  StepDescription step;
  if (const YamlCursor* value = map.find("max_step_s")) step.max_step_s = value->number(kMaxStepRange);
  if (const YamlCursor* value = map.find("max_gap_s")) step.max_gap_s = value->number(kMaxGapRange);
  if (const YamlCursor* value = map.find("joint_states")) step.joint_states = value->choice(kStatePolicies);
  if (const YamlCursor* value = map.find("max_lag_s")) step.max_lag_s = value->number(kMaxLagRange);
  if (step.max_gap_s < step.max_step_s) {
    cursor.fail("max_gap_s is shorter than max_step_s; it must be at least as long");
  }
  constexpr double kMostStepsPerGap = 1e5;  // a late joint state must not keep the node busy for minutes
  // 0.1 is a little more than 1e5 times 1e-6 in binary: both are read to half a unit in the last place, the product is
  // rounded once more. Nobody types ratios that differ by less than this.
  constexpr double kRoundOff = 1e-9;
  if (step.max_gap_s > (1.0 + kRoundOff) * kMostStepsPerGap * step.max_step_s) {
    const YamlCursor* gap = map.find("max_gap_s");
    (gap == nullptr ? cursor : *gap)
        .fail("is more than 100000 times max_step_s; shorten max_gap_s or lengthen max_step_s");
  }
  return step;
}

// 0.1: beyond a tenth of the contact force the answer is another one. 0: nothing sleeps that is held by anything.
constexpr Range kSleepErrorRange{0.0, 0.1, "", "give a share: 0.1 % is 0.001"};

/// `word` or `auto`.
/// @return whether it is `word`.
bool isWord(const YamlCursor& cursor, const char* word) {
  const std::pair<const char*, bool> words[] = {{"auto", false}, {word, true}};
  return cursor.choice(words);
}

AdvisorDescription parseAdvisor(const YamlCursor& cursor) {
  const YamlMap map = cursor.map();
  AdvisorDescription advisor;
  if (const YamlCursor* value = map.find("sleep")) advisor.sleep = !isWord(*value, "never");
  if (const YamlCursor* value = map.find("sleep_error")) advisor.sleep_error = value->number(kSleepErrorRange);
  if (const YamlCursor* value = map.find("rotations")) advisor.adapt_rotations = !isWord(*value, "always");
  if (const YamlCursor* value = map.find("self_contact")) advisor.skip_folds = !isWord(*value, "always");
  if (const YamlCursor* value = map.find("friction_path")) advisor.general_friction = isWord(*value, "general");
  return advisor;
}

void parseBodies(const YamlMap& map, const PathContext& paths, Scene& scene) {
  NameLines lines;
  for (const YamlCursor& element : map.get("tissues").list(1, kMostBodies)) {
    scene.tissues.push_back(parseTissue(element, paths));
    addName(scene.tissues.back().name, element, lines);
  }
  if (const YamlCursor* instruments = map.find("instruments")) {
    for (const YamlCursor& element : instruments->list(0, kMostBodies)) {
      scene.instruments.push_back(parseInstrument(element, paths));
      addName(scene.instruments.back().name, element, lines);
    }
  }
}

void parseSections(const YamlMap& map, const PathContext& paths, Scene& scene) {
  if (const YamlCursor* value = map.find("world_frame")) scene.world_frame = parseFrame(*value);
  if (const YamlCursor* value = map.find("gravity_m_per_s2")) scene.gravity_m_per_s2 = value->vector3(kGravityRange);
  parseBodies(map, paths, scene);
  if (const YamlCursor* value = map.find("tissue_pairs")) scene.tissue_pairs = parseTissuePairs(*value, scene);
  if (const YamlCursor* value = map.find("friction")) scene.friction = parseFrictionPairs(*value, scene);
  if (const YamlCursor* value = map.find("step")) scene.step = parseStep(*value);
  if (const YamlCursor* value = map.find("solver")) scene.solver = parseSolver(*value);
  if (const YamlCursor* value = map.find("advisor")) scene.advisor = parseAdvisor(*value);
  if (const YamlCursor* value = map.find("publish")) value->map();  // read by whoever publishes
}

Scene parse(const std::string& yaml, const std::string& file, const PackagePath& package_path,
            const std::vector<std::string>& settings, const ReadMore& read_more) {
  const YamlMap map = parseYaml(yaml, file, settings).map();
  const PathContext paths{fs::path(file).parent_path().string(), package_path};
  Scene scene;
  scene.file = file;
  try {
    parseSections(map, paths, scene);
    if (read_more) read_more(map);
    map.cursor().addLines(scene.entry_lines);
  } catch (const EntryError& error) {  // of a room's own check, which knows no lines
    map.cursor().addLines(scene.entry_lines);
    const SetPlaces& set = map.cursor().set();
    const std::string* setting = settingOf(set, error.entry());
    const std::string place =
        setting != nullptr ? *setting + ": " + error.entry() : placeOf(scene, error.entry()) + withSettings(set);
    throw std::invalid_argument(place + ": " + error.what());
  }
  return scene;
}

}  // namespace

Scene parseScene(const std::string& yaml, const std::string& file, const PackagePath& package_path,
                 const std::vector<std::string>& settings) {
  return parse(yaml, file, package_path, settings, nullptr);
}

Scene loadScene(const std::string& file, const PackagePath& package_path, const std::vector<std::string>& settings) {
  return loadScene(file, package_path, settings, nullptr);
}

Scene loadScene(const std::string& file, const PackagePath& package_path, const std::vector<std::string>& settings,
                const ReadMore& read_more) {
  // Only URIs: messages and Scene::file keep a plain path as it was given.
  const bool is_uri = file.find("://") != std::string::npos;
  const std::string path = is_uri ? resolvePath(file, "", package_path) : file;
  return parse(readFile(path, "scene file", kMaxSceneBytes), path, package_path, settings, read_more);
}

}  // namespace tissue_contact
