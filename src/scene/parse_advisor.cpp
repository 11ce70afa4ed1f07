#include "scene_sections.h"

namespace tissue_contact {
namespace {

// 0.1: beyond a tenth of the contact force the answer is another one. 0: nothing sleeps that is held by anything.
constexpr Range kSleepErrorRange{0.0, 0.1, "", "give a share: 0.1 % is 0.001"};

/// `word` or `auto`. @return whether it is `word`.
bool isWord(const YamlCursor& cursor, const char* word) {
  const std::pair<const char*, bool> words[] = {{"auto", false}, {word, true}};
  return cursor.choice(words);
}

}  // namespace

AdvisorDescription parseAdvisor(const YamlCursor& cursor) {
  const YamlMap map = cursor.map(MapKind::kAdvisor);
  AdvisorDescription advisor;
  if (const YamlCursor* value = map.find("sleep")) advisor.sleep = !isWord(*value, "never");
  if (const YamlCursor* value = map.find("sleep_error")) advisor.sleep_error = value->number(kSleepErrorRange);
  if (const YamlCursor* value = map.find("rotations")) advisor.adapt_rotations = !isWord(*value, "always");
  if (const YamlCursor* value = map.find("self_contact")) advisor.skip_folds = !isWord(*value, "always");
  if (const YamlCursor* value = map.find("friction_path")) advisor.general_friction = isWord(*value, "general");
  return advisor;
}

}  // namespace tissue_contact
